// The pose of a frame from the map as the released program finds it
// (PARAMETERS.md#pose-estimation): its features against the descriptors of all landmarks, and EPnP
// RANSAC on the matches.
#pragma once

#include <optional>

#include "workload/vio/frame.h"
#include "workload/vio/inertial_part.h"
#include "workload/vio/levio/geometry/sampling.h"

namespace leviosim::vio::levio {

/// Marks the features that show a landmark, where there are enough matches for their ages to be
/// looked at. Without enough inliers the pose is the predicted one, and report.source says so;
/// without enough matches there is none.
/// @return T_world_camera
template <class P>
std::optional<Pose<P>> pose_from_landmarks(const FrontEndState<P>& state,
                                           const InertialPart<P>& inertial,
                                           ShiftRegister<P>& random, Frame<P>& frame,
                                           FrameReport& report);

// The pose of a frame from its matches with the last keyframe as the released program finds it
// (PARAMETERS.md#eight-point-algorithm): 8-point RANSAC, and the pose of the essential matrix.

/// The translation, whose length two views do not tell, is as long as the last velocity suggests.
/// Without enough matches the keyframe's pose is kept, and report.source says so.
/// @return T_world_camera
template <class P>
Pose<P> pose_from_keyframe(const FrontEndState<P>& state, ShiftRegister<P>& random,
                           const Frame<P>& frame, FrameReport& report);

}  // namespace leviosim::vio::levio
