// Which estimated pose belongs to which true one, and how far along the true path it lies. The
// truth is interpolated at the stamps of the estimate: positions linearly, rotations by slerp. It
// is never extrapolated.
#pragma once

#include <Eigen/Geometry>

#include <cstdint>
#include <vector>

#include "traces/trajectories/trajectory.h"

namespace leviosim::traces {

/// An estimated pose and the true pose at its time, both of the body frame.
struct MatchedPose {
  std::int64_t t_ns = 0;
  Eigen::Isometry3d estimate = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
};

/// Matches every pose of the estimate that lies within the span of the truth and no farther than
/// `max_gap_ns` from its nearest sample.
std::vector<MatchedPose> associate(const Trajectory& estimate, const Trajectory& truth,
                                   std::int64_t max_gap_ns);

/// Length of the true path from the first match to each one [m], along all samples of `truth`, so
/// that it does not depend on how often the estimate has a pose. `truth` is that of associate().
std::vector<double> distances_along(const Trajectory& truth,
                                    const std::vector<MatchedPose>& matches);

}  // namespace leviosim::traces
