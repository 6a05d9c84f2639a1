// The relative pose of two views from their essential matrix as the released program recovers it
// (PARAMETERS.md#pose-recovery): of the four poses that it admits, the one that puts most points in
// front of both cameras. For each pose the team triangulates all matches, inliers or not, and the
// master alone tests the depths.
//
// Left out: the length of the translation, which two views do not tell. It comes out as 1.
#pragma once

#include "sim/work/machine.h"
#include "workload/levio/geometry/camera_constants.h"
#include "workload/levio/geometry/two_view_point.h"
#include "workload/math/matrix.h"

namespace leviosim::vio::levio {

/// Where both views saw the matches, in px: match i at a[2i], a[2i+1] and b[2i], b[2i+1].
template <class P>
struct PixelMatches {
  typename P::template EitherSpan<const typename P::F32> a, b;
  int n;
};

template <class P>
struct RecoveredPose {
  bool ok = false;   ///< false if no point lies in front of both cameras for any pose
  Pose<P> T_b_a{};   ///< |t| = 1
  int in_front = 0;  ///< matches in front of both cameras
};

/// Local memory of recover_pose(), all cores at work.
inline Bytes recovery_memory(int matches, int cores) {
  return Bytes(4LL * (4 * 16 + 16) + 4LL * 3 * matches) + kTriangulationScratch * cores;
}

/// Works inside a stage of `machine`.
/// @param essential  3×3, x_bᵀ E x_a = 0
template <class P>
RecoveredPose<P> recover_pose(work::Machine& machine, MatrixView<P> essential,
                              const PixelMatches<P>& matches, const CameraConstants<P>& camera);

}  // namespace leviosim::vio::levio
