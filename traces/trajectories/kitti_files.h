// The KITTI odometry benchmark's text files. Poses: a line holds the upper three rows of
// T_world_camera, row by row, 12 numbers and no time stamp. Times: a line holds seconds.
// Left out: that KITTI's poses are those of a camera (x right, y down, z forward). They are taken
// as they are, so "up" is z in files whose world has z up only.
#pragma once

#include <Eigen/Geometry>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace leviosim::traces {

/// Throws InputError (file, line, column) for broken rows, matrices that are no rotation within
/// 1e-3, and files without a pose. [m]
std::vector<Eigen::Isometry3d> read_kitti_poses(const std::filesystem::path& file);

/// Nanoseconds. Throws InputError (file, line) for broken rows and stamps that do not rise.
std::vector<std::int64_t> read_times(const std::filesystem::path& file);

}  // namespace leviosim::traces
