// Tests that a map, a pose or a rotation is physically possible for a vehicle.
#pragma once

#include "workload/next/prediction.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

/// Whether velocity and biases of the newest keyframe, and its pose, are within
/// RecoveryOptions. @param is_aligned  the pose is tested, too: before the alignment it may change
/// by metres
template <class P>
bool map_is_plausible(const FrontEndState<P>& state, const Prediction<P>& prediction,
                      bool is_aligned);

/// Whether the vehicle can have moved from the last reported pose to T_world_camera.
/// @param seconds  the time since then, at most
template <class P>
bool pose_is_plausible(const FrontEndState<P>& state, const Prediction<P>& prediction,
                       const Pose<P>& T_world_camera, float seconds);

/// Whether the gyro measured this rotation since the keyframe, within the largest bias. The 8-point
/// algorithm chooses a wrong one of its four solutions at times, and a map that begins with it is
/// of no use.
template <class P>
bool agrees_with_gyro(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                      const Mat3<P>& R_camera_keyframe);

}  // namespace leviosim::vio
