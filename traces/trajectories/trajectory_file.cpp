#include "traces/trajectories/trajectory_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/row_values.h"
#include "traces/trajectories/kitti_files.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;

struct FormatRow {
  TrajectoryFormat format;
  std::string_view option;
  std::string_view name;
  base::Separator separator;
  std::size_t columns;
  std::string (*text)(const Trajectory& trajectory);
};

constexpr std::array<FormatRow, 3> kTrajectoryFormats{{
    {TrajectoryFormat::tum, "tum", "TUM", base::Separator::blanks, 8, format_tum},
    {TrajectoryFormat::euroc, "euroc", "EuRoC", base::Separator::comma, 17, format_euroc},
    {TrajectoryFormat::kitti, "kitti", "KITTI", base::Separator::blanks, 12, format_kitti},
}};

constexpr const char* kRunTrajectory = "trajectory.tum";
constexpr const char* kTumTruth = "groundtruth.txt";

Trajectory numbered(const std::vector<Eigen::Isometry3d>& poses) {
  Trajectory trajectory;
  for (const Eigen::Isometry3d& pose : poses)
    trajectory.push_back({static_cast<std::int64_t>(trajectory.size()), pose});
  return trajectory;
}

void stamp(TrajectoryFile& trajectory, const fs::path& times_file) {
  const std::vector<std::int64_t> times = read_times(times_file);
  if (times.size() != trajectory.poses.size())
    throw InputError(fmt::format("{}: holds {} time stamps; expected {}, the poses of {}",
                                 times_file.string(), times.size(), trajectory.poses.size(),
                                 trajectory.file.string()));
  for (std::size_t i = 0; i < times.size(); ++i) trajectory.poses[i].t_ns = times[i];
  trajectory.stamps = Stamps::time;
}

void check_stamps(const TrajectoryPair& pair) {
  const auto& [estimate, truth] = pair;
  if (estimate.stamps != truth.stamps) {
    const bool first = estimate.stamps == Stamps::pose_number;
    throw InputError(fmt::format(
        "{}: has no time stamps (KITTI), but {} has; expected a file with its times",
        (first ? estimate : truth).file.string(), (first ? truth : estimate).file.string()));
  }
  if (estimate.stamps == Stamps::pose_number && estimate.poses.size() != truth.poses.size())
    throw InputError(fmt::format(
        "{}: holds {} poses and {} {}; expected as many of both where there are no time stamps",
        estimate.file.string(), estimate.poses.size(), truth.file.string(), truth.poses.size()));
}

}  // namespace

std::string_view name_of(TrajectoryFormat format) {
  return kTrajectoryFormats[static_cast<std::size_t>(format)].name;
}

TrajectoryFormat parse_trajectory_format(std::string_view name) {
  for (const FormatRow& row : kTrajectoryFormats)
    if (row.option == name) return row.format;
  throw InputError(fmt::format("format '{}': expected one of tum, euroc, kitti", name));
}

std::string trajectory_text(std::string_view format, const Trajectory& trajectory) {
  if (format == "jsonl") return format_json_lines(trajectory);
  for (const FormatRow& row : kTrajectoryFormats)
    if (row.option == format) return row.text(trajectory);
  throw InputError(fmt::format("format '{}': expected one of tum, euroc, kitti, jsonl", format));
}

TrajectoryFormat detect_format(const fs::path& file) {
  const base::FirstRow first = base::first_row(file);
  for (const FormatRow& row : kTrajectoryFormats)
    if (row.separator == first.separator && row.columns == first.columns) return row.format;
  constexpr std::size_t kPoseOnly = 8;  // as TUM-VI has them
  if (first.separator == base::Separator::comma && first.columns == kPoseOnly)
    return TrajectoryFormat::euroc;
  throw InputError(fmt::format(
      "{}: {} columns separated by {}; expected 8 (TUM) or 12 (KITTI) separated by blanks, or 17 "
      "(EuRoC) by commas",
      base::at_line(file, first.line), first.columns,
      first.separator == base::Separator::comma ? "commas" : "blanks"));
}

fs::path find_trajectory(const fs::path& path) {
  if (!base::exists(path))
    throw InputError(fmt::format("{}: no such file or folder", path.string()));
  if (!base::is_folder(path)) return path;
  std::vector<fs::path> found;
  for (const fs::path& candidate :
       {path / kRunTrajectory, path / "mav0" / kTruthCsv, path / kTruthCsv,
        path / "mav0" / kMocapCsv, path / kMocapCsv, path / kTumTruth})
    if (base::is_file(candidate)) found.push_back(candidate);
  if (found.size() == 1) return found.front();
  if (found.empty())
    throw InputError(
        fmt::format("{}: holds no trajectory; expected a run folder with {}, an ASL folder with "
                    "mav0/{}, or a TUM folder with {}",
                    path.string(), kRunTrajectory, kTruthCsv, kTumTruth));
  throw InputError(fmt::format("{}: holds {} and {}; name the file that is meant", path.string(),
                               found[0].string(), found[1].string()));
}

TrajectoryFile read_trajectory(const fs::path& path, const ReadOptions& options) {
  TrajectoryFile result;
  result.file = find_trajectory(path);
  const bool forced = options.format && result.file == path;
  result.format = forced ? *options.format : detect_format(result.file);
  switch (result.format) {
    case TrajectoryFormat::tum:
      result.poses = read_tum(result.file);
      break;
    case TrajectoryFormat::euroc:
      result.poses = read_euroc_trajectory(result.file);
      break;
    case TrajectoryFormat::kitti:
      result.poses = numbered(read_kitti_poses(result.file));
      result.stamps = Stamps::pose_number;
      if (!options.times.empty()) stamp(result, options.times);
      break;
  }
  return result;
}

TrajectoryPair read_pair(const fs::path& estimate, const fs::path& truth,
                         const ReadOptions& options) {
  TrajectoryPair pair{read_trajectory(estimate, options), read_trajectory(truth, options)};
  const bool any_kitti = pair.estimate.format == TrajectoryFormat::kitti ||
                         pair.truth.format == TrajectoryFormat::kitti;
  if (!options.times.empty() && !any_kitti)
    throw InputError(fmt::format("{}: time stamps are for KITTI files; {} and {} have their own",
                                 options.times.string(), pair.estimate.file.string(),
                                 pair.truth.file.string()));
  check_stamps(pair);
  return pair;
}

}  // namespace leviosim::traces
