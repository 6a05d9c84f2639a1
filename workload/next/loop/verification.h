// Whether a view shows a place, and from where: matches of descriptors, a pose with the vertical
// that gravity gives (upright_pose.h), a search for all points of the place around that pose, and
// the same again with what is found. The last word has what is missing: of the points that the pose
// puts into the image, a share has to be there. A texture that is found again elsewhere does not
// bring its surroundings along; nor may they be missing from a whole stripe of the image.
#pragma once

#include <optional>

#include "sim/work/machine.h"
#include "workload/levio/geometry/sampling.h"
#include "workload/next/loop/yaw_transform.h"
#include "workload/vio/loop_options.h"
#include "workload/vision/features.h"

namespace leviosim::vio {

/// The camera that all views were taken with.
struct LoopCamera {
  PinholeCamera camera{};
  int width = 0, height = 0;  ///< px
  int steps = 1;              ///< feature coordinates are in units of 1/steps px
};

/// A place in local memory.
template <class P>
struct StoredView {
  typename P::template Span<typename P::U32> descriptors;  ///< 8 words for every point
  typename P::template Span<typename P::F32> points;  ///< 3 for every point: from its camera, in
                                                      ///< the axes of the odometry then, m
  int count = 0;
};

template <class P>
struct Recognised {
  /// From the axes of StoredView to the view's: from its camera, in the odometry's axes now.
  YawTransform<P> T_view_place;
  int inliers = 0;
};

/// Works inside a stage of `machine`.
/// @param features           of the view, in local memory
/// @param R_odometry_camera  of the view
template <class P>
std::optional<Recognised<P>> recognise(work::Machine& machine, const StoredView<P>& place,
                                       const FeatureList<P>& features,
                                       const Mat3<P>& R_odometry_camera, const LoopCamera& camera,
                                       const VerificationOptions& options,
                                       levio::ShiftRegister<P>& random);

}  // namespace leviosim::vio
