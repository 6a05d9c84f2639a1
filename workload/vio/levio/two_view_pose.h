// The pose of a frame from its matches with the last keyframe as the released program finds it
// (PARAMETERS.md#eight-point-algorithm): 8-point RANSAC, and the pose of the essential matrix.
#pragma once

#include "workload/vio/frame.h"
#include "workload/vio/levio/geometry/sampling.h"

namespace leviosim::vio::levio {

/// The translation, whose length two views do not tell, is as long as the last velocity suggests.
/// Without enough matches the keyframe's pose is kept, and report.source says so.
/// @return T_world_camera
template <class P>
Pose<P> pose_from_keyframe(const FrontEndState<P>& state, ShiftRegister<P>& random,
                           const Frame<P>& frame, FrameReport& report);

}  // namespace leviosim::vio::levio
