// Triangulation of a point from two views as the released program does it
// (PARAMETERS.md#triangulation): the smallest eigenvector of AᵀA by inverse power, from pixels
// whose coordinates are normalised every time; and the squared reprojection error by generic
// product.
#pragma once

#include "sim/work/arena.h"
#include "workload/levio/geometry/camera_constants.h"
#include "workload/math/matrix.h"

namespace leviosim::vio::levio {

/// Scratch of one triangulation.
inline constexpr Bytes kTriangulationScratch{144};

/// The point seen at the pixels `a` and `b` by two cameras. May lie behind them; not a number if
/// the matrix is singular. Takes kTriangulationScratch during the call.
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
