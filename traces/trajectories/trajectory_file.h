// Trajectories as people have them: TUM, EuRoC or KITTI files, recognised by their content, or a
// folder that holds one.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "traces/trajectories/evaluation.h"
#include "traces/trajectories/trajectory.h"
#include "traces/trajectories/trajectory_alignment.h"

namespace leviosim::traces {

enum class TrajectoryFormat {
  tum,    ///< "t x y z qx qy qz qw", t in seconds
  euroc,  ///< the 17 columns of state_groundtruth_estimate0/data.csv, or the first 8 of them
  kitti,  ///< 12 numbers, no time stamp
};

/// "TUM", "EuRoC", "KITTI".
std::string_view name_of(TrajectoryFormat format);

/// The format called "tum", "euroc" or "kitti". Throws InputError for others.
TrajectoryFormat parse_trajectory_format(std::string_view name);

/// The text of a trajectory in the format called "tum", "euroc", "kitti" or "jsonl". Throws
/// InputError for others.
std::string trajectory_text(std::string_view format, const Trajectory& trajectory);

/// The format of a file, by the columns of its first row. Throws InputError (file, line) if it has
/// none or those of no format.
TrajectoryFormat detect_format(const std::filesystem::path& file);

/// The file itself; of a run folder its trajectory.tum; of a folder of ASL or TUM its ground truth.
/// Throws InputError if there is none, or several.
std::filesystem::path find_trajectory(const std::filesystem::path& file_or_folder);

struct TrajectoryFile {
  std::filesystem::path file;
  TrajectoryFormat format = TrajectoryFormat::tum;
  Stamps stamps = Stamps::time;
  Trajectory poses;  ///< without time stamps, t_ns is the pose's number
};

struct ReadOptions {
  std::optional<TrajectoryFormat> format;  ///< detected if absent; not for what a folder holds
  std::filesystem::path times;             ///< time stamps of a KITTI file; none if empty
};

/// Throws InputError (file, line) for anything that cannot be read, and for times of another number
/// than poses.
TrajectoryFile read_trajectory(const std::filesystem::path& file_or_folder,
                               const ReadOptions& options = {});

struct TrajectoryPair {
  TrajectoryFile estimate;
  TrajectoryFile truth;
};

/// Reads estimate and truth with one set of options. Throws InputError as read_trajectory() does,
/// if one has time stamps and the other none, if neither has any and the numbers of poses differ,
/// and for times that neither file needs.
TrajectoryPair read_pair(const std::filesystem::path& estimate, const std::filesystem::path& truth,
                         const ReadOptions& options = {});

}  // namespace leviosim::traces
