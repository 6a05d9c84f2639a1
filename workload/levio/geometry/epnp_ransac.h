// RANSAC around EPnP as the released program runs it (PARAMETERS.md#epnp): in batches
// of one sample for each core, or a few, the master draws and copies the samples, the team solves
// one hypothesis per sample, and the master scores all of them serially over all matches.
//
// The best hypothesis is the result however few its inliers are. Left out, as in the release: early
// termination, and a final refit to the inliers.
#pragma once

#include "sim/work/machine.h"
#include "workload/levio/geometry/epnp.h"
#include "workload/levio/geometry/sampling.h"

namespace leviosim::vio::levio {

/// Matches of landmarks and pixels.
template <class P>
struct LandmarkMatches {
  typename P::template EitherSpan<const typename P::F32> points;  ///< 3 per match, world frame, m
  typename P::template EitherSpan<const typename P::F32> pixels;  ///< 2 per match: u, v in px
  int n = 0;                                                      ///< at least kEpnpSample
};

struct EpnpRansacOptions {
  int iterations = 64;
  int batch = 0;  ///< hypotheses per fork; 0: as the team has cores (sampling.h)
  float inlier_px = 1.41421356f;
};

template <class P>
struct EpnpResult {
  bool ok = false;  ///< false if no hypothesis was a number
  Pose<P> T_camera_world{};
  int inliers = 0;  ///< matches with a reprojection error below inlier_px
};

/// Local memory while it runs with one hypothesis for each core.
/// @param matches  the most that there can be
Bytes epnp_memory(int matches, int cores);

/// Works inside a stage of `machine`.
template <class P>
EpnpResult<P> estimate_pose_epnp(work::Machine& machine, const LandmarkMatches<P>& matches,
                                 const CameraConstants<P>& camera, ShiftRegister<P>& random,
                                 const EpnpRansacOptions& options);

}  // namespace leviosim::vio::levio
