// EPnP as the released program computes it (PARAMETERS.md#epnp): the pose of a camera from four
// matches of points and pixels. The method is that of V. Lepetit, F. Moreno-Noguer, P. Fua, "EPnP:
// an accurate O(n) solution to the PnP problem", IJCV 2009.
//
// Nothing is checked on the way: a sample whose third axis has no length gives a pose that is not a
// number, after the work that any other sample takes.
#pragma once

#include "sim/work/arena.h"
#include "workload/levio/geometry/camera_constants.h"
#include "workload/math/matrix.h"

namespace leviosim::vio::levio {

inline constexpr int kEpnpSample = 4;  ///< matches
inline constexpr int kMostEpnpRotations = 120;
inline constexpr float kEpnpTolerance = 1e-8f;  ///< of the rotations, at a Frobenius norm of 1
/// Penalty on a reprojection error for each metre behind the camera [px/m].
inline constexpr float kDepthPenalty = 1000.0f;

template <class P>
struct EpnpSample {
  MatrixView<P> points;  ///< 4×3, world frame, m
  MatrixView<P> pixels;  ///< 4×2
};

/// Scratch of one hypothesis, in whole words.
inline constexpr Bytes kEpnpScratch{3260};

/// Takes kEpnpScratch during the call.
/// @param T_camera_world  4×4, the result
/// @return the mean reprojection error of the sample, px, with the penalty for depth
template <class P>
typename P::F32 solve_epnp(const EpnpSample<P>& sample, const CameraConstants<P>& camera,
                           MatrixView<P> T_camera_world, work::Arena& scratch);

/// Penalty of a depth: none in front of the camera.
template <class P>
typename P::F32 depth_penalty(typename P::F32 depth) {
  using F = typename P::F32;
  return work::max(F(-depth), F(0.0f)) * F(kDepthPenalty);
}

}  // namespace leviosim::vio::levio
