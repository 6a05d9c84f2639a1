// The relative pose of two views from their essential matrix as the released program recovers it
// (PARAMETERS.md#pose-recovery): of the four poses that it admits, the one that puts most points in
// front of both cameras. For each pose the team triangulates all matches, inliers or not, and the
// master alone tests the depths.
//
// Left out: the length of the translation, which two views do not tell. It comes out as 1.
#pragma once

#include "sim/work/arena.h"
#include "sim/work/machine.h"
#include "workload/levio/geometry/camera_constants.h"
#include "workload/math/matrix.h"

namespace leviosim::vio::levio {

/// Where both views saw the matches, in px: match i at a[2i], a[2i+1] and b[2i], b[2i+1].
template <class P>
struct PixelMatches {
  typename P::template Span<const typename P::F32> a, b;
  int n;
};

template <class P>
struct RecoveredPose {
  bool ok = false;   ///< false if no point lies in front of both cameras for any pose
  Pose<P> T_b_a{};   ///< |t| = 1
  int in_front = 0;  ///< matches in front of both cameras
};

/// Works inside a stage of `machine`.
/// @param essential  3×3, x_bᵀ E x_a = 0
template <class P>
RecoveredPose<P> recover_pose(work::Machine& machine, MatrixView<P> essential,
                              const PixelMatches<P>& matches, const CameraConstants<P>& camera);

// Triangulation of a point from two views as the released program does it
// (PARAMETERS.md#triangulation): the smallest eigenvector of AᵀA by inverse power, from pixels
// whose coordinates are normalised every time; and the squared reprojection error by generic
// product.

/// The point seen at the pixels `a` and `b` by two cameras. May lie behind them; not a number if
/// the matrix is singular. Takes 144 bytes of scratch during the call.
/// @param T_a  4×4, from the frame that the point shall be in to camera a
/// @param T_b  likewise for camera b
template <class P>
Vec3<P> triangulate(ConstMatrixView<P> T_a, ConstMatrixView<P> T_b, const Vec2<P>& a,
                    const Vec2<P>& b, const CameraConstants<P>& camera, work::Arena& scratch);

/// Squared distance in px² between the projection of a point and the pixel where it was seen; two
/// divisions. A point behind the camera has one, too.
template <class P>
typename P::F32 reprojection_error_sq(ConstMatrixView<P> T_camera_world, const Vec3<P>& point,
                                      const Vec2<P>& seen, const CameraConstants<P>& camera);

}  // namespace leviosim::vio::levio
