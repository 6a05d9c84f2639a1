// Trajectories and their text formats. TUM: one pose a line, "t x y z qx qy qz qw", t in seconds
// with 9 decimals, which evo and rpg_trajectory_evaluation read. EuRoC: the 17 columns of
// state_groundtruth_estimate0/data.csv.
#pragma once

#include <Eigen/Geometry>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "traces/datasets/dataset.h"

namespace leviosim::traces {

struct StampedPose {
  std::int64_t t_ns = 0;
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();  ///< [m]
};

/// In order of time.
using Trajectory = std::vector<StampedPose>;

/// The text of a TUM file. Nine decimals everywhere, qw >= 0, no negative zero: the same poses give
/// the same bytes.
std::string format_tum(const Trajectory& trajectory);
/// The same, line by line.
void write_tum(const Trajectory& trajectory, const std::function<void(std::string_view)>& sink);

/// The first 8 columns of a EuRoC ground-truth csv: nanoseconds, position, w x y z.
std::string format_euroc(const Trajectory& trajectory);
/// KITTI's 12 numbers a line, without times.
std::string format_kitti(const Trajectory& trajectory);
/// A JSON object a line: {"t_ns":0,"p":[x,y,z],"q":[w,x,y,z]}.
std::string format_json_lines(const Trajectory& trajectory);

/// Throws InputError (file, line, column) for broken rows, stamps that do not rise, quaternions
/// whose norm is not 1 within 1e-3, and files without a pose. Stamps are exact to the nanosecond;
/// those in scientific notation as exact as a double is.
Trajectory read_tum(const std::filesystem::path& file);

/// Reads the poses of a EuRoC ground-truth csv. Throws as read_ground_truth_csv does.
Trajectory read_euroc_trajectory(const std::filesystem::path& file);

Trajectory to_trajectory(const std::vector<GroundTruthPose>& ground_truth);

}  // namespace leviosim::traces
