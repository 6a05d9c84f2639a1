#include "traces/trajectories/kitti_files.h"

#include <fmt/core.h>

#include "sim/base/csv.h"
#include "sim/base/error.h"

namespace leviosim::traces {
namespace {

constexpr double kRotationTolerance = 1e-3;

Eigen::Isometry3d pose_of(const base::CsvRow& row) {
  Eigen::Matrix<double, 3, 4> m;
  for (int i = 0; i < 12; ++i) m(i / 4, i % 4) = row.number(static_cast<std::size_t>(i));
  const Eigen::Matrix3d rotation = m.leftCols<3>();
  const double off =
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kRotationTolerance))
    row.fail(fmt::format(
        "columns 1-3, 5-7, 9-11 are no rotation: R*R' is off the identity by {:.3g}", off));
  if (rotation.determinant() < 0)
    row.fail("columns 1-3, 5-7, 9-11 are a reflection instead of a rotation");
  return Eigen::Translation3d(m.col(3)) * Eigen::Quaterniond(rotation).normalized();
}

}  // namespace

std::vector<Eigen::Isometry3d> read_kitti_poses(const std::filesystem::path& file) {
  base::CsvReader csv(
      file, base::Separator::blanks,
      {"r11", "r12", "r13", "tx", "r21", "r22", "r23", "ty", "r31", "r32", "r33", "tz"});
  std::vector<Eigen::Isometry3d> poses;
  while (const base::CsvRow* row = csv.next()) poses.push_back(pose_of(*row));
  if (poses.empty()) throw InputError(fmt::format("{}: holds no pose", file.string()));
  return poses;
}

std::vector<std::int64_t> read_times(const std::filesystem::path& file) {
  base::CsvReader csv(file, base::Separator::blanks, {"time [s]"});
  base::RisingStamps stamps;
  std::vector<std::int64_t> times;
  while (const base::CsvRow* row = csv.next()) {
    times.push_back(row->nanoseconds_from_seconds(0));
    stamps.add(*row, times.back());
  }
  return times;
}

}  // namespace leviosim::traces
