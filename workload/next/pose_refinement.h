// Pose of the camera from all its matches with landmarks: Gauss–Newton on the reprojection errors,
// with a robust (Huber) weight and a predicted pose as prior.
//
// Unknown is δ in T_camera_world = exp(δ) T: a rotation and a translation in the camera frame, in
// which a point moves by φ × x + ρ. Each core sums the normal equations of its share of the matches
// (team fork "normal equations"); the master adds them up and solves. A last fork, "inliers", marks
// the matches that agree with the result.
#pragma once

#include "sim/work/machine.h"
#include "workload/levio/geometry/epnp_ransac.h"
#include "workload/math/vec.h"
#include "workload/vio/profile.h"

namespace leviosim::vio {

template <class P>
struct RefinedPose {
  bool ok = false;  ///< false if the normal equations could not be solved
  Pose<P> T_camera_world{};
  int inliers = 0;
};

/// Works inside a stage of `machine`.
/// @param T_predicted  T_camera_world: where the iteration starts, and the prior
/// @param inliers      one byte per match: 1 or 0
template <class P>
RefinedPose<P> refine_pose(work::Machine& machine, const levio::LandmarkMatches<P>& matches,
                           const PinholeCamera& camera, const Pose<P>& T_predicted,
                           const RefinementOptions& options,
                           typename P::template Span<typename P::Byte> inliers);

}  // namespace leviosim::vio
