// The pose of a frame from the map alone: its features against the descriptors of all landmarks,
// and EPnP RANSAC on the matches (paper III.B.3).
#pragma once

#include <optional>

#include "workload/vio/frame.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

/// Marks the features that show a landmark. Without enough inliers the pose is the predicted one,
/// and report.source says so; without enough matches there is none.
/// @return T_world_camera
template <class P>
std::optional<Pose<P>> pose_from_landmarks(const FrontEndState<P>& state,
                                           const InertialPart<P>& inertial, Frame<P>& frame,
                                           FrameReport& report);

}  // namespace leviosim::vio
