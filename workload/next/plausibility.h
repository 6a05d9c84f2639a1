// What cannot be true: maps, poses and rotations beyond what a vehicle does.
#pragma once

#include "workload/next/prediction.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

/// Whether the map has a meaning.
/// @param stays  poses do not change by metres any more, as they may before a map is aligned
template <class P>
bool map_is_plausible(const FrontEndState<P>& state, const Prediction<P>& prediction, bool stays);

/// Whether T_world_camera is a pose to which the camera can have got from where it was reported
/// last.
/// @param seconds  that this took at most
template <class P>
bool pose_is_plausible(const FrontEndState<P>& state, const Prediction<P>& prediction,
                       const Pose<P>& T_world_camera, float seconds);

/// Whether the gyro saw this rotation since the keyframe, but for the largest bias.
/// The 8-point algorithm's choice among its four solutions is wrong at times, and a map that begins
/// with one is of no use.
template <class P>
bool agrees_with_gyro(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                      const Mat3<P>& R_camera_keyframe);

}  // namespace leviosim::vio
