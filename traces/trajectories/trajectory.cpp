#include "traces/trajectories/trajectory.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <iterator>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/row_values.h"

namespace leviosim::traces {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

/// Flips the sign so that the first component of (w, x, y, z) that is not zero is positive.
Eigen::Quaterniond canonical(const Eigen::Quaterniond& q) {
  for (const double component : {q.w(), q.x(), q.y(), q.z()}) {
    if (component > 0) return q;
    if (component < 0) return Eigen::Quaterniond(-q.coeffs());
  }
  return q;
}

/// With nine decimals, and no negative zero.
void append_numbers(std::string& out, char separator, std::initializer_list<double> values,
                    bool at_start = false) {
  constexpr double kPrintsAsZero = 0.5e-9;
  for (const double value : values) {
    if (!at_start) out += separator;
    fmt::format_to(std::back_inserter(out), "{:.9f}", std::abs(value) < kPrintsAsZero ? 0 : value);
    at_start = false;
  }
}

Eigen::Quaterniond attitude_of(const StampedPose& pose) {
  return canonical(Eigen::Quaterniond(pose.T_world_body.linear()).normalized());
}

}  // namespace

std::string format_tum(const Trajectory& trajectory) {
  std::string text;
  write_tum(trajectory, [&](std::string_view line) { text += line; });
  return text;
}

void write_tum(const Trajectory& trajectory, const std::function<void(std::string_view)>& sink) {
  sink("# timestamp tx ty tz qx qy qz qw\n");
  std::string out;
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d p = pose.T_world_body.translation();
    const Eigen::Quaterniond q = attitude_of(pose);
    fmt::format_to(std::back_inserter(out), "{}.{:09d}", pose.t_ns / kNsPerSecond,
                   pose.t_ns % kNsPerSecond);
    append_numbers(out, ' ', {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
    out += '\n';
    sink(out);
    out.clear();
  }
}

std::string format_euroc(const Trajectory& trajectory) {
  std::string out =
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],"
      "q_RS_z []\n";
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d p = pose.T_world_body.translation();
    const Eigen::Quaterniond q = attitude_of(pose);
    fmt::format_to(std::back_inserter(out), "{}", pose.t_ns);
    append_numbers(out, ',', {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
    out += '\n';
  }
  return out;
}

std::string format_kitti(const Trajectory& trajectory) {
  std::string out;
  for (const StampedPose& pose : trajectory) {
    const Eigen::Matrix4d m = pose.T_world_body.matrix();
    for (int row = 0; row < 3; ++row)
      append_numbers(out, ' ', {m(row, 0), m(row, 1), m(row, 2), m(row, 3)}, row == 0);
    out += '\n';
  }
  return out;
}

std::string format_json_lines(const Trajectory& trajectory) {
  std::string out;
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d p = pose.T_world_body.translation();
    const Eigen::Quaterniond q = attitude_of(pose);
    fmt::format_to(std::back_inserter(out), "{{\"t_ns\":{},\"p\":[", pose.t_ns);
    append_numbers(out, ',', {p.x(), p.y(), p.z()}, true);
    out += "],\"q\":[";
    append_numbers(out, ',', {q.w(), q.x(), q.y(), q.z()}, true);
    out += "]}\n";
  }
  return out;
}

Trajectory read_tum(const std::filesystem::path& file) {
  base::CsvReader csv(file, base::Separator::blanks,
                      {"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"});
  base::RisingStamps stamps;
  Trajectory trajectory;
  while (const base::CsvRow* row = csv.next()) {
    const std::int64_t t_ns = row->nanoseconds_from_seconds(0);
    stamps.add(*row, t_ns);
    const Eigen::Translation3d p(row->number(1), row->number(2), row->number(3));
    trajectory.push_back({t_ns, p * quaternion_at(*row, 4, QuaternionOrder::xyzw)});
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
