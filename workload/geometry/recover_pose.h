// The relative pose of two views from their essential matrix (PARAMETERS.md#pose-recovery):
// of the four poses that an essential matrix admits, the one that puts most matches in front of
// both cameras, decided by triangulating them. One fork per pose; the cores share the matches.
//
// Left out: the length of the translation, which two views do not tell. It comes out as 1.
#pragma once

#include "sim/work/arena.h"
#include "sim/work/machine.h"
#include "workload/geometry/essential_ransac.h"
#include "workload/math/vec.h"

namespace leviosim::vio {

// Triangulation of one point from two views: linear (DLT), the smallest eigenvector of the 4x4
// matrix AᵀA by inverse power iteration (PARAMETERS.md#triangulation), and the test that a
// triangulated point must pass to become a landmark.
//
// Left out: any refinement of the linear solution, and scaling of A. The point comes out in the
// frame in which both poses are given. AᵀA squares the condition of A in single precision, so far
// from the origin of that frame (more than some 10 m for a baseline of 10 cm) accuracy drops; give
// the poses relative to one of the cameras where that matters.

/// Of the inverse power iteration, as for the essential matrix (essential_ransac.h).
struct TriangulationOptions {
  int max_power_steps = 15;
  float power_tolerance = 1e-8f;
};
/// A new landmark needs a squared reprojection error below this in both keyframes, in px².
inline constexpr float kLandmarkErrorSq = 2.0f;

template <class P>
struct Triangulated {
  bool valid;     ///< false if the rays are parallel within single precision
  Vec3<P> point;  ///< in the world frame; zero if not valid
};

/// The point seen at `a` and `b` (normalised image coordinates) by two cameras.
///
/// May lie behind a camera. Takes 176 bytes of scratch during the call.
template <class P>
Triangulated<P> triangulate(const Pose<P>& T_a_world, const Pose<P>& T_b_world, const Vec2<P>& a,
                            const Vec2<P>& b, work::Arena& scratch,
                            const TriangulationOptions& options = {});

/// Squared distance, in px², between the projection of a world point and where it was seen
/// (normalised image coordinates). Not finite for a point in the plane of the camera.
template <class P>
typename P::F32 reprojection_error_sq(const Pose<P>& T_camera_world, const Vec3<P>& point,
                                      const Vec2<P>& seen, const PinholeCamera& camera);

/// Whether the point lies in front of the camera and reprojects with a squared error below
/// `max_error_sq` px².
template <class P>
bool agrees_with_view(const Pose<P>& T_camera_world, const Vec3<P>& point, const Vec2<P>& seen,
                      const PinholeCamera& camera, float max_error_sq = kLandmarkErrorSq);

/// Whether a point infinitely far away would be seen at `a` and `b` as well, with a squared error
/// below `max_error_sq` px²: then the two views say nothing about its depth.
template <class P>
bool agrees_with_infinity(const Pose<P>& T_a_world, const Pose<P>& T_b_world, const Vec2<P>& a,
                          const Vec2<P>& b, const PinholeCamera& camera,
                          float max_error_sq = kLandmarkErrorSq);

struct RecoverPoseOptions {
  TriangulationOptions triangulation;
  int max_svd_rotations = 10;
  DiagonalPrecision svd_precision = DiagonalPrecision::Double;
};

template <class P>
struct TwoViewPose {
  bool ok;        ///< false if no match lies in front of both cameras for any pose
  Pose<P> T_b_a;  ///< |t| = 1; identity if not ok
  int in_front;   ///< matches in front of both cameras
};

/// The four poses T_b_a with E = ± [t]× R and |t| = 1.
template <class P>
struct FourPoses {
  Pose<P> T_b_a[4];
};
template <class P>
FourPoses<P> decompose_essential(const Mat3<P>& E, const RecoverPoseOptions& options = {});

/// @param mask  one element per match, 0 for those to leave out; or an empty view to use them all
template <class P>
TwoViewPose<P> recover_pose(work::Machine& machine, const TwoViewMatches<P>& matches,
                            typename P::template Span<const typename P::Byte> mask,
                            const Mat3<P>& E, const RecoverPoseOptions& options = {});

}  // namespace leviosim::vio
