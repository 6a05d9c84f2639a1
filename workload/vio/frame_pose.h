// The pose of a frame from the map alone, as the released program finds it
// (PARAMETERS.md#pose-estimation): its features against the descriptors of all landmarks, and EPnP
// RANSAC on the matches (paper III.B.3).
#pragma once

#include <optional>

#include "workload/levio/geometry/epnp_ransac.h"
#include "workload/levio/geometry/sampling.h"
#include "workload/vio/frame.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

/// Marks the features that show a landmark, where there are enough matches for their ages to be
/// looked at. Without enough inliers the pose is the predicted one, and report.source says so;
/// without enough matches there is none.
/// @param epnp  how many poses are tried, and how
/// @return T_world_camera
template <class P>
std::optional<Pose<P>> pose_from_landmarks(const FrontEndState<P>& state,
                                           const InertialPart<P>& inertial,
                                           levio::ShiftRegister<P>& random,
                                           const levio::EpnpRansacOptions& epnp, Frame<P>& frame,
                                           FrameReport& report);

}  // namespace leviosim::vio
