// The pose of a frame from its matches with the last keyframe as the released program finds it
// (PARAMETERS.md#eight-point-algorithm): 8-point RANSAC, and the pose of the essential matrix
// (paper III.B.4).
#pragma once

#include <functional>

#include "workload/levio/geometry/sampling.h"
#include "workload/vio/frame.h"

namespace leviosim::vio {

/// Local memory of pose_from_keyframe(), at most.
template <class P>
Bytes keyframe_pose_memory(const FrontEndState<P>& state);

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
