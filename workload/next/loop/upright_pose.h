// The pose of a camera whose vertical is known, from matches of points with pixels. It has four
// unknowns, so two points fix it: RANSAC over pairs of matches, and Gauss–Newton on the
// reprojection errors of many. A match that only a tilted camera would see is rejected.
//
// Points are relative to some origin, in axes with z up; the view has axes of its own, with z up
// likewise and the camera as origin. Unknown is x → Rz(yaw) x + t from the former to the latter.
#pragma once

#include "sim/work/machine.h"
#include "workload/levio/geometry/epnp_ransac.h"
#include "workload/levio/geometry/sampling.h"
#include "workload/next/loop/yaw_transform.h"
#include "workload/vio/loop_options.h"

namespace leviosim::vio {

template <class P>
struct UprightInput {
  levio::LandmarkMatches<P> matches;  ///< its points in the axes of the origin
  PinholeCamera camera;
  Mat3<P> R_camera_upright;  ///< of the view
};

/// The pose of a camera, of points in upright axes.
template <class P>
Pose<P> upright_camera_pose(const Mat3<P>& R_camera_upright, const YawTransform<P>& T);

/// The poses that bring two points into two pixels: none, one, or two.
template <class P>
struct PairSolution {
  int count = 0;
  YawTransform<P> T[2];
};
template <class P>
PairSolution<P> solve_pair(const UprightInput<P>& input, typename P::I32 first,
                           typename P::I32 second);

/// Works inside a stage of `machine`. Team fork: "solve pairs". The result does not depend on the
/// number of cores.
template <class P>
struct UprightPose {
  YawTransform<P> T = YawTransform<P>::identity();
  int inliers = 0;
};
template <class P>
UprightPose<P> find_upright_pose(work::Machine& machine, const UprightInput<P>& input,
                                 const UprightOptions& options, levio::ShiftRegister<P>& random);

/// On the calling core.
/// @return false if the normal equations could not be solved
template <class P>
bool refine_upright_pose(work::Arena& local, const UprightInput<P>& input,
                         const UprightOptions& options, YawTransform<P>& T);

/// One byte per match: 1 if its reprojection error is below `inlier_px`.
/// @return how many are
template <class P>
int mark_inliers(const UprightInput<P>& input, const YawTransform<P>& T, float inlier_px,
                 float min_depth, typename P::template Span<typename P::Byte> inliers);

}  // namespace leviosim::vio
