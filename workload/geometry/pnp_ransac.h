// Pose of the camera from matches between landmarks and pixels: EPnP inside RANSAC (paper section
// III, "EPnP RANSAC"; parameters and parallel form from PARAMETERS.md#epnp).
//
// In batches of 8 iterations the master draws the samples serially, the team solves one hypothesis
// per sample, and the master counts the inliers of all hypotheses serially and keeps the best.
//
// Left out, as in the modelled pipeline: early termination, and a final refit to all inliers.
#pragma once

#include "sim/work/machine.h"
#include "workload/geometry/epnp.h"

namespace leviosim::vio {

template <class P>
struct PnpResult {
  bool ok = false;           ///< a pose was found, with at least as many inliers as a sample has
  Pose<P> T_camera_world{};  ///< meaningful if ok
  int inliers = 0;           ///< matches with a reprojection error below inlier_px
  typename P::F32 mean_error_px = 0.0f;  ///< of the inliers
};

/// Works inside a stage of `machine`. Takes 2·n + 60·batch + 48 bytes of its local memory (for
/// samples of 4) and about 3 kB of the scratch of each core. The result does not depend on the
/// number of cores.
template <class P>
PnpResult<P> estimate_pose_epnp(work::Machine& machine, const PnpInput<P>& input,
                                const PnpOptions& options);

}  // namespace leviosim::vio
