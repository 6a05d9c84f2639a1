// The pose of a frame from the map alone, as the released program finds it
// (PARAMETERS.md#pose-estimation): its features against the descriptors of all landmarks, and EPnP
// RANSAC on the matches (paper III.B.3).
#pragma once

#include <functional>
#include <optional>

#include "workload/levio/geometry/sampling.h"
#include "workload/vio/frame.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

/// Marks the features that show a landmark, where there are enough matches for their ages to be
/// looked at. Without enough inliers the pose is the predicted one, and report.source says so;
/// without enough matches there is none.
/// @return T_world_camera
template <class P>
std::optional<Pose<P>> pose_from_landmarks(const FrontEndState<P>& state,
                                           const InertialPart<P>& inertial,
                                           levio::ShiftRegister<P>& random, Frame<P>& frame,
                                           FrameReport& report);

// The pose of a frame from its matches with the last keyframe as the released program finds it
// (PARAMETERS.md#eight-point-algorithm): 8-point RANSAC, and the pose of the essential matrix
// (paper III.B.4).

/// Whether R_camera_keyframe, as the essential matrix has it, can be true.
template <class P>
using RotationCheck = std::function<bool(const Mat3<P>& R_camera_keyframe)>;

/// The translation, whose length two views do not tell, is as long as the last velocity suggests.
/// Without enough matches, or if `can_be_true` is given and says no, the keyframe's pose is kept,
/// and report.source says so.
/// @return T_world_camera
template <class P>
Pose<P> pose_from_keyframe(const FrontEndState<P>& state, levio::ShiftRegister<P>& random,
                           const Frame<P>& frame, const RotationCheck<P>& can_be_true,
                           FrameReport& report);

}  // namespace leviosim::vio
