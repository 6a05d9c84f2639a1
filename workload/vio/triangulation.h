// Triangulation of one point from two views: linear (DLT), the smallest eigenvector of the 4x4
// matrix AᵀA by inverse power iteration (PARAMETERS.md#triangulation), and the tests that a
// triangulated point must pass to become a landmark.
//
// Left out: any refinement of the linear solution, and scaling of A. The point comes out in the
// frame in which both poses are given. AᵀA squares the condition of A in single precision, so far
// from the origin of that frame (more than some 10 m for a baseline of 10 cm) accuracy drops; give
// the poses relative to one of the cameras where that matters.
#pragma once

#include "sim/work/arena.h"
#include "workload/math/vec.h"

namespace leviosim::vio {

template <class P>
struct Triangulated {
  bool valid;     ///< false if the rays are parallel within single precision
  Vec3<P> point;  ///< in the world frame; zero if not valid
};

inline constexpr Bytes kTriangulationScratch{176};

/// The point seen at `a` and `b` (normalised image coordinates) by two cameras.
///
/// May lie behind a camera. Takes kTriangulationScratch during the call.
template <class P>
Triangulated<P> triangulate(const Pose<P>& T_a_world, const Pose<P>& T_b_world, const Vec2<P>& a,
                            const Vec2<P>& b, work::Arena& scratch);

/// Whether the point lies in front of the camera and reprojects with a squared error below
/// `max_error_sq` px².
template <class P>
bool agrees_with_view(const Pose<P>& T_camera_world, const Vec3<P>& point, const Vec2<P>& seen,
                      const PinholeCamera& camera, float max_error_sq);

/// Whether a point infinitely far away would be seen at `a` and `b` as well, with a squared error
/// below `max_error_sq` px²: then the two views say nothing about its depth.
template <class P>
bool agrees_with_infinity(const Pose<P>& T_a_world, const Pose<P>& T_b_world, const Vec2<P>& a,
                          const Vec2<P>& b, const PinholeCamera& camera, float max_error_sq);

}  // namespace leviosim::vio
