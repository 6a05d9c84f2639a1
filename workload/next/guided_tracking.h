// Tracking by prediction: the predicted pose gives the search regions of the landmarks, and the
// pose is refined to all that are found. EPnP RANSAC is used for recovery only.
#pragma once

#include <optional>

#include "workload/levio/geometry/sampling.h"
#include "workload/next/motion_record.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

/// Finds the pose among the landmarks: near the prediction, then in a wider search, then, lost, by
/// pose_from_landmarks(). The features then know their landmarks.
/// @param T_predicted  T_world_camera
/// @return T_world_camera, if enough landmarks agree with one
template <class P>
std::optional<Pose<P>> track_landmarks(const FrontEndState<P>& state,
                                       const InertialPart<P>& inertial,
                                       levio::ShiftRegister<P>& random, const Pose<P>& T_predicted,
                                       TrackedFrame<P>& frame, FrameReport& report);

}  // namespace leviosim::vio
