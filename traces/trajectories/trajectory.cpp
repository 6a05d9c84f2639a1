#include "traces/trajectories/trajectory.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/outputs/atomic_file.h"
#include "traces/datasets/asl_reader.h"

namespace leviosim::traces {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr double kQuaternionTolerance = 1e-3;

/// Flips the sign so that the first component of (w, x, y, z) that is not zero is positive.
Eigen::Quaterniond canonical(const Eigen::Quaterniond& q) {
  for (const double component : {q.w(), q.x(), q.y(), q.z()}) {
    if (component > 0) return q;
    if (component < 0) return Eigen::Quaterniond(-q.coeffs());
  }
  return q;
}

void append_number(std::string& out, double value) {
  constexpr double kPrintsAsZero = 0.5e-9;
  if (std::abs(value) < kPrintsAsZero) value = 0;
  fmt::format_to(std::back_inserter(out), " {:.9f}", value);
}

}  // namespace

std::string format_tum(const Trajectory& trajectory) {
  std::string out = "# timestamp tx ty tz qx qy qz qw\n";
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d p = pose.T_world_body.translation();
    const Eigen::Quaterniond q =
        canonical(Eigen::Quaterniond(pose.T_world_body.linear()).normalized());
    fmt::format_to(std::back_inserter(out), "{}.{:09d}", pose.t_ns / kNsPerSecond,
                   pose.t_ns % kNsPerSecond);
    for (const double value : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()})
      append_number(out, value);
    out += '\n';
  }
  return out;
}

void write_tum(const std::filesystem::path& file, const Trajectory& trajectory) {
  outputs::write_file_atomically(file, format_tum(trajectory));
}

Trajectory read_tum(const std::filesystem::path& file) {
  base::CsvReader csv(file, base::Separator::blanks,
                      {"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"});
  base::RisingStamps stamps;
  Trajectory trajectory;
  while (const base::CsvRow* row = csv.next()) {
    const std::int64_t t_ns = row->nanoseconds_from_seconds(0);
    stamps.add(*row, t_ns);
    const Eigen::Quaterniond q(row->number(7), row->number(4), row->number(5), row->number(6));
    if (std::abs(q.norm() - 1) > kQuaternionTolerance)
      row->fail(fmt::format("the quaternion has norm {:.6f} instead of 1", q.norm()));
    const Eigen::Translation3d p(row->number(1), row->number(2), row->number(3));
    trajectory.push_back({t_ns, p * q.normalized()});
  }
  if (trajectory.empty()) throw InputError(fmt::format("{}: holds no pose", file.string()));
  return trajectory;
}

Trajectory read_euroc_trajectory(const std::filesystem::path& file) {
  return to_trajectory(read_ground_truth_csv(file));
}

Trajectory to_trajectory(const std::vector<GroundTruthPose>& ground_truth) {
  Trajectory trajectory;
  trajectory.reserve(ground_truth.size());
  for (const GroundTruthPose& pose : ground_truth)
    trajectory.push_back({pose.t_ns, pose.T_world_body});
  return trajectory;
}

}  // namespace leviosim::traces
