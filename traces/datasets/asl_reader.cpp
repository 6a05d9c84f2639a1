#include "traces/datasets/asl_reader.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "traces/datasets/row_values.h"
#include "traces/datasets/sensor_yaml.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTruth = "state_groundtruth_estimate0";
constexpr const char* kMocap = "mocap0";

double seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

/// The mav0 folder in or at `folder`.
fs::path find_mav0(const fs::path& folder) {
  if (!base::exists(folder)) throw InputError(fmt::format("{}: no such folder", folder.string()));
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

/// What headings call a column, without the frames of its name: "w_RS_S_x" is "wx".
struct Quantity {
  std::string_view name;
  std::string_view unit;  ///< as EuRoC writes it
  bool has_axes = true;
};
constexpr Quantity kQuantities[] = {{"timestamp", "ns", false},
                                    {"filename", "", false},
                                    {"w", "rad s^-1"},
                                    {"a", "m s^-2"},
                                    {"p", "m"},
                                    {"q", ""},
                                    {"v", "m s^-1"},
                                    {"b_w", "rad s^-1"},
                                    {"b_a", "m s^-2"}};

/// "q_RS_w" and "q.w" to "qw".
std::string short_name(std::string_view name) {
  std::string all;
  for (std::size_t begin = 0; begin < name.size();) {
    const std::size_t end = std::min(name.find_first_of("_. ", begin), name.size());
    const std::string_view part = name.substr(begin, end - begin);
    if (part == "b")
      all += "b_";  // a "baz" is no bias
    else if (part != "RS" && part != "R" && part != "S")
      all += part;
    begin = end + 1;
  }
  return all;
}

const Quantity* quantity_of(std::string_view short_name) {
  const auto is_it = [&](const Quantity& q) {
    if (!q.has_axes || short_name.empty()) return short_name == q.name;
    const bool has_axis = std::string_view("xyzw").find(short_name.back()) != std::string::npos;
    return has_axis && short_name.substr(0, short_name.size() - 1) == q.name;
  };
  const auto found = std::find_if(std::begin(kQuantities), std::end(kQuantities), is_it);
  return found == std::end(kQuantities) ? nullptr : found;
}

/// "m s^-2" and "m/sec^2" to the same text, which is empty for numbers without a unit.
std::string plain_unit(std::string_view unit) {
  std::string text;
  for (const char c : unit)
    if (std::string_view(" ^*1").find(c) == std::string_view::npos) text += c;
  for (const auto& [from, to] : {std::pair{"sec", "s"}, {"s-", "/s"}})
    for (std::size_t at; (at = text.find(from)) != std::string::npos;)
      text.replace(at, std::string_view(from).size(), to);
  return text;
}

/// A heading that names a known column in the place of another one, or with another unit, is of a
/// table that would be read wrongly. Other words say nothing.
void require_heading(base::CsvReader& csv, const std::vector<std::string>& names) {
  const std::vector<std::string_view> heading = csv.heading();
  for (std::size_t i = 0; i < std::min(heading.size(), names.size()); ++i) {
    const std::string_view cell = heading[i];
    const std::size_t bracket = std::min(cell.find('['), cell.size());
    const std::string found = short_name(cell.substr(0, bracket));
    if (quantity_of(found) == nullptr) continue;
    const std::string_view name = std::string_view(names[i]).substr(0, names[i].find(" ["));
    const std::string_view unit = quantity_of(short_name(name))->unit;
    const std::string_view inside = cell.substr(std::min(bracket + 1, cell.size()));
    const std::string found_unit = plain_unit(inside.substr(0, inside.find(']')));
    if (found == short_name(name) && (found_unit.empty() || found_unit == plain_unit(unit)))
      continue;
    constexpr std::size_t kLongest = 40;
    throw InputError(fmt::format("{}, column {}: found '{}'; expected '{}{}'",
                                 base::at_line(csv.file(), 1), i + 1, cell.substr(0, kLongest),
                                 name, unit.empty() ? "" : fmt::format(" [{}]", unit)));
  }
}

}  // namespace

std::vector<FrameRef> read_frames_csv(const fs::path& data_csv) {
  const std::vector<std::string> names{"timestamp [ns]", "filename"};
  base::CsvReader csv(data_csv, base::Separator::comma, names);
  require_heading(csv, names);
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
  const std::vector<std::string> names{"timestamp [ns]", "w_RS_S_x", "w_RS_S_y", "w_RS_S_z",
                                       "a_RS_S_x",       "a_RS_S_y", "a_RS_S_z"};
  base::CsvReader csv(data_csv, base::Separator::comma, names);
  require_heading(csv, names);
  base::RisingStamps stamps;
  std::vector<ImuSample> samples;
  while (const base::CsvRow* row = csv.next()) {
    const std::int64_t t_ns = row->nanoseconds(0);
    stamps.add(*row, t_ns);
    samples.push_back({t_ns, vector_at(*row, 1, kGyroBound), vector_at(*row, 4, kAccelBound)});
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
  base::CsvReader csv(data_csv, base::Separator::comma, names);
  require_heading(csv, names);
  base::RisingStamps stamps;
  std::vector<GroundTruthPose> poses;
  while (const base::CsvRow* row = csv.next()) {
    GroundTruthPose pose;
    pose.t_ns = row->nanoseconds(0);
    stamps.add(*row, pose.t_ns);
    pose.T_world_body =
        Eigen::Translation3d(vector_at(*row, 1, kPositionBound)) * quaternion_at(*row, 4);
    if (!only_poses) {
      pose.velocity = vector_at(*row, 8, kVelocityBound);
      pose.bias_gyro = vector_at(*row, 11, kGyroBound);
      pose.bias_accel = vector_at(*row, 14, kAccelBound);
    }
    poses.push_back(pose);
  }
  require_rows(poses.size(), data_csv);
  return poses;
}

std::vector<InputFiles> asl_files(const fs::path& mav0) {
  std::vector<InputFiles> files;
  for (const char* name : {"cam0/sensor.yaml", "cam0/data.csv", "imu0/sensor.yaml", "imu0/data.csv",
                           kTruthCsv, kMocapCsv})
    if (base::exists(mav0 / name)) files.push_back({name, {mav0 / name}});
  return files;
}

void read_asl_streams(const fs::path& mav0, Dataset& data) {
  data.frames_csv = require_file(mav0, "cam0/data.csv");
  data.imu_csv = require_file(mav0, "imu0/data.csv");
  data.frames = read_frames_csv(data.frames_csv);
  data.imu = read_imu_csv(data.imu_csv);
  for (const auto& [folder, csv] : {std::pair{kTruth, kTruthCsv}, std::pair{kMocap, kMocapCsv}}) {
    if (!base::exists(mav0 / folder)) continue;
    data.truth_csv = require_file(mav0, csv);
    data.ground_truth = read_ground_truth_csv(data.truth_csv);
    break;
  }
  data.files = asl_files(mav0);
}

bool is_asl(const fs::path& folder) {
  for (const char* part : {"mav0", "cam0", "imu0"})
    if (base::is_folder(folder / part)) return true;
  return false;
}

Dataset read_asl(const fs::path& folder) {
  const fs::path mav0 = find_mav0(folder);
  Dataset data;
  data.camera = read_camera_model(require_file(mav0, "cam0/sensor.yaml"));
  data.imu_model = read_imu_model(require_file(mav0, "imu0/sensor.yaml"));
  read_asl_streams(mav0, data);
  take_faulty_pixels(mav0 / "cam0/sensor.yaml", data);
  expect_rates(mav0, data);
  apply_calibration(data);
  return data;
}

Dataset open_asl(const fs::path& folder, const OpenOptions& options) {
  return opened(read_asl(folder), options);
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
