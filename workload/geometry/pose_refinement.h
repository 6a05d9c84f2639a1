// Pose of the camera from all its matches with landmarks: Gauss–Newton on the reprojection errors,
// with a robust (Huber) weight and a predicted pose as prior.
//
// Unknown is δ in T_camera_world = exp(δ) T: a rotation and a translation in the camera frame, in
// which a point moves by φ × x + ρ. Each core sums the normal equations of its share of the matches
// (team fork "normal equations"); the master adds them up and solves. A last fork, "inliers", marks
// the matches that agree with the result.
#pragma once

#include "sim/work/machine.h"
#include "workload/geometry/pnp_ransac.h"

namespace leviosim::vio {

/// Chosen on the rendered EuRoC flights (ACCURACY.md).
struct RefinementOptions {
  int steps = 4;
  float sigma_px = 1.0f;
  float huber_px = 1.0f;    ///< errors count linearly from here on
  float inlier_px = 3.0f;   ///< of a match that agrees
  float min_share = 0.6f;   ///< of the matches that must agree; of wrong ones found within 8 px, a
                            ///< seventh does by chance
  float rotation = 0.02f;   ///< standard deviation of the prior, each axis, rad
  float position = 0.05f;   ///< likewise, m
  float min_depth = 0.05f;  ///< of a landmark in view, m
};

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
RefinedPose<P> refine_pose(work::Machine& machine, const PnpInput<P>& matches,
                           const Pose<P>& T_predicted, const RefinementOptions& options,
                           typename P::template Span<typename P::Byte> inliers);

}  // namespace leviosim::vio
