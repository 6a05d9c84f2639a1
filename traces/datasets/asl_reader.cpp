#include "traces/datasets/asl_reader.h"

#include <fmt/core.h>

#include <cmath>
#include <string>
#include <utility>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "traces/datasets/sensor_yaml.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;

constexpr double kQuaternionTolerance = 1e-3;
constexpr const char* kTruth = "state_groundtruth_estimate0";
constexpr const char* kMocap = "mocap0";
constexpr double kGapSlack = 1.01;  // recorded stamps jitter by a few hundred nanoseconds

double seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

void require_rows(std::size_t rows, const fs::path& file) {
  if (rows == 0) throw InputError(fmt::format("{}: the sequence is empty (no row)", file.string()));
}

/// The largest magnitude of a kind of quantity.
struct Bound {
  double most;
  const char* what;
};
// The fastest gyroscopes end at 70 rad/s and shock sensors at 2000 m/s². Positions of 1e7 m span
// the Earth. Squares and integrals of such values stay numbers in single precision, too.
constexpr Bound kGyro{1e3, "any gyroscope [rad/s]"};
constexpr Bound kAccel{1e4, "any accelerometer [m/s^2]"};
constexpr Bound kPosition{1e7, "any flight [m]"};
constexpr Bound kVelocity{1e5, "any flight [m/s]"};

Eigen::Vector3d vector_at(const base::CsvRow& row, std::size_t column, const Bound& bound) {
  Eigen::Vector3d vector;
  for (int k = 0; k < 3; ++k) {
    const std::size_t at = column + static_cast<std::size_t>(k);
    vector[k] = row.number(at);
    if (std::abs(vector[k]) > bound.most)
      row.fail(at, fmt::format("beyond {}; expected from {} to {}", bound.what, -bound.most,
                               bound.most));
  }
  return vector;
}

Eigen::Quaterniond quaternion_at(const base::CsvRow& row, std::size_t w_column) {
  const Eigen::Quaterniond q(row.number(w_column), row.number(w_column + 1),
                             row.number(w_column + 2), row.number(w_column + 3));
  if (std::abs(q.norm() - 1) > kQuaternionTolerance)
    row.fail(fmt::format("the quaternion has norm {:.6f} instead of 1", q.norm()));
  return q.normalized();
}

/// The mav0 folder in or at `folder`.
fs::path find_mav0(const fs::path& folder) {
  if (!base::exists(folder)) throw InputError(fmt::format("{}: no such folder", folder.string()));
  const fs::path kind = folder.extension();
  if (base::is_file(folder) && (kind == ".bag" || kind == ".db3" || kind == ".mcap"))
    throw InputError(
        fmt::format("{}: a ROS bag; convert it to an ASL folder, with mav0/{{cam0,imu0}}, each "
                    "with sensor.yaml and data.csv",
                    folder.string()));
  if (base::is_folder(folder / "mav0")) return folder / "mav0";
  return folder;
}

fs::path require_file(const fs::path& mav0, const char* name) {
  if (!base::is_file(mav0 / name))
    throw InputError(fmt::format(
        "{} not found in {}; an ASL folder has mav0/{{cam0,imu0}}, each with sensor.yaml and "
        "data.csv",
        name, mav0.string()));
  return mav0 / name;
}

void select_frames(std::vector<FrameRef>& frames, const FrameRange& range, const fs::path& csv) {
  check_frame_range(range, frames.size(), csv.string());
  frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(range.end), frames.end());
  frames.erase(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(range.begin));
}

void require_images(const std::vector<FrameRef>& frames, const fs::path& csv) {
  for (const FrameRef& frame : frames) {
    const base::PathKind kind = base::kind_of(frame.path);
    if (kind == base::PathKind::file) continue;
    throw InputError(
        fmt::format("{}: the image {} {}", base::at_line(csv, frame.line), frame.path.string(),
                    kind == base::PathKind::missing ? "does not exist" : "is no regular file"));
  }
}

/// Frames outside the samples by more than `tolerance_s`.
void require_cover(const Dataset& data, double tolerance_s, const fs::path& imu_csv) {
  const auto fail = [&](const FrameRef& frame, std::int64_t edge, const char* where) {
    throw InputError(fmt::format(
        "{}: the frame at {} ns lies {:.4f} s {} IMU sample of {} ({} ns); choose frames that the "
        "IMU covers",
        base::at_line(data.frames_csv, frame.line), frame.t_ns,
        std::abs(seconds(frame.t_ns - edge)), where, imu_csv.string(), edge));
  };
  const FrameRef& first = data.frames.front();
  const FrameRef& last = data.frames.back();
  if (seconds(data.imu.front().t_ns - first.t_ns) > tolerance_s)
    fail(first, data.imu.front().t_ns, "before the first");
  if (seconds(last.t_ns - data.imu.back().t_ns) > tolerance_s)
    fail(last, data.imu.back().t_ns, "after the last");
}

void require_no_gaps(const Dataset& data, double longest_s, const fs::path& imu_csv) {
  for (std::size_t i = 1; i < data.imu.size(); ++i) {
    const std::int64_t from = data.imu[i - 1].t_ns;
    const std::int64_t to = data.imu[i].t_ns;
    if (to <= data.frames.front().t_ns || from >= data.frames.back().t_ns) continue;
    if (seconds(to - from) > longest_s * kGapSlack)
      throw InputError(fmt::format(
          "{}: IMU gap of {:.3f} ms between {} ns and {} ns; at most {:.3f} ms is allowed "
          "({:g} Hz sensor)",
          imu_csv.string(), seconds(to - from) * 1e3, from, to, longest_s * 1e3,
          data.imu_model.rate_hz));
  }
}

/// Poses between which a path can be interpolated.
void require_smooth_truth(const std::vector<GroundTruthPose>& poses, const fs::path& truth_csv) {
  if (poses.size() < 2)
    throw InputError(
        fmt::format("{}: one pose is no motion; expected at least 2 rows", truth_csv.string()));
  for (std::size_t i = 1; i < poses.size(); ++i)
    if (seconds(poses[i].t_ns - poses[i - 1].t_ns) > kLongestTruthGapS)
      throw InputError(fmt::format(
          "{}: no pose for {:.3f} s between {} ns and {} ns; at most {:g} s can be interpolated",
          truth_csv.string(), seconds(poses[i].t_ns - poses[i - 1].t_ns), poses[i - 1].t_ns,
          poses[i].t_ns, kLongestTruthGapS));
}

}  // namespace

std::vector<FrameRef> read_frames_csv(const fs::path& data_csv) {
  base::CsvReader csv(data_csv, base::Separator::comma, {"timestamp [ns]", "filename"});
  base::RisingStamps stamps;
  std::vector<FrameRef> frames;
  while (const base::CsvRow* row = csv.next()) {
    const std::int64_t t_ns = row->nanoseconds(0);
    stamps.add(*row, t_ns);
    if (row->text(1).empty()) row->fail(1, "not a file name");
    frames.push_back({t_ns, data_csv.parent_path() / "data" / row->text(1), row->line()});
  }
  require_rows(frames.size(), data_csv);
  return frames;
}

std::vector<ImuSample> read_imu_csv(const fs::path& data_csv) {
  base::CsvReader csv(
      data_csv, base::Separator::comma,
      {"timestamp [ns]", "w_RS_S_x", "w_RS_S_y", "w_RS_S_z", "a_RS_S_x", "a_RS_S_y", "a_RS_S_z"});
  base::RisingStamps stamps;
  std::vector<ImuSample> samples;
  while (const base::CsvRow* row = csv.next()) {
    const std::int64_t t_ns = row->nanoseconds(0);
    stamps.add(*row, t_ns);
    samples.push_back({t_ns, vector_at(*row, 1, kGyro), vector_at(*row, 4, kAccel)});
  }
  require_rows(samples.size(), data_csv);
  return samples;
}

std::vector<GroundTruthPose> read_ground_truth_csv(const fs::path& data_csv) {
  std::vector<std::string> names{
      "timestamp",  "p_RS_R_x",   "p_RS_R_y",   "p_RS_R_z",   "q_RS_w",    "q_RS_x",
      "q_RS_y",     "q_RS_z",     "v_RS_R_x",   "v_RS_R_y",   "v_RS_R_z",  "b_w_RS_S_x",
      "b_w_RS_S_y", "b_w_RS_S_z", "b_a_RS_S_x", "b_a_RS_S_y", "b_a_RS_S_z"};
  constexpr std::size_t kOfPose = 8;
  const bool only_poses = base::first_row(data_csv).columns == kOfPose;
  if (only_poses) names.resize(kOfPose);
  base::CsvReader csv(data_csv, base::Separator::comma, std::move(names));
  base::RisingStamps stamps;
  std::vector<GroundTruthPose> poses;
  while (const base::CsvRow* row = csv.next()) {
    GroundTruthPose pose;
    pose.t_ns = row->nanoseconds(0);
    stamps.add(*row, pose.t_ns);
    pose.T_world_body =
        Eigen::Translation3d(vector_at(*row, 1, kPosition)) * quaternion_at(*row, 4);
    if (!only_poses) {
      pose.velocity = vector_at(*row, 8, kVelocity);
      pose.bias_gyro = vector_at(*row, 11, kGyro);
      pose.bias_accel = vector_at(*row, 14, kAccel);
    }
    poses.push_back(pose);
  }
  require_rows(poses.size(), data_csv);
  return poses;
}

Dataset open_asl(const fs::path& folder, const OpenOptions& options) {
  const fs::path mav0 = find_mav0(folder);
  const fs::path camera_yaml = require_file(mav0, "cam0/sensor.yaml");
  const fs::path frames_csv = require_file(mav0, "cam0/data.csv");
  const fs::path imu_yaml = require_file(mav0, "imu0/sensor.yaml");
  const fs::path imu_csv = require_file(mav0, "imu0/data.csv");

  Dataset data;
  data.frames_csv = frames_csv;
  data.camera = read_camera_model(camera_yaml);
  data.imu_model = read_imu_model(imu_yaml);
  data.frames = read_frames_csv(frames_csv);
  data.imu = read_imu_csv(imu_csv);
  if (base::exists(mav0 / kTruth))
    data.ground_truth = read_ground_truth_csv(require_file(mav0, kTruthCsv));
  else if (base::exists(mav0 / kMocap))
    data.ground_truth = read_ground_truth_csv(require_file(mav0, kMocapCsv));

  if (options.frames) select_frames(data.frames, *options.frames, frames_csv);
  require_images(data.frames, frames_csv);
  const double period_s = 1 / data.imu_model.rate_hz;
  require_cover(data, options.imu_edge_periods * period_s, imu_csv);
  require_no_gaps(data, options.max_imu_gap_periods * period_s, imu_csv);
  disturb(data, options.disturbance);
  return data;
}

MotionRecord open_motion(const fs::path& folder) {
  MotionRecord record;
  record.mav0 = find_mav0(folder);
  const fs::path truth_csv = require_file(record.mav0, kTruthCsv);
  record.camera = read_camera_model(require_file(record.mav0, "cam0/sensor.yaml"));
  record.imu_model = read_imu_model(require_file(record.mav0, "imu0/sensor.yaml"));
  record.ground_truth = read_ground_truth_csv(truth_csv);
  require_smooth_truth(record.ground_truth, truth_csv);
  if (base::exists(record.mav0 / "imu0/data.csv"))
    record.imu = read_imu_csv(record.mav0 / "imu0/data.csv");
  if (base::exists(record.mav0 / "cam0/data.csv"))
    for (const FrameRef& frame : read_frames_csv(record.mav0 / "cam0/data.csv"))
      record.frame_stamps.push_back(frame.t_ns);
  return record;
}

}  // namespace leviosim::traces
