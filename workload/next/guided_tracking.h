// Tracking by prediction: where the camera must be by now tells where to look for landmarks, and
// the pose is refined to all that are found. EPnP RANSAC is left for recovery.
#pragma once

#include <optional>

#include "workload/levio/geometry/sampling.h"
#include "workload/next/motion_record.h"
#include "workload/vio/frame.h"
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

// Features placed between pixels: those that match the last keyframe's are moved to where the
// patches around them agree with it (patch_alignment.h), and landmarks that the keyframe saw, but
// the detector has not found again, are looked for where the camera's pose predicts them.

/// Works in a stage of its own. Of images of which two have no room in local memory, the cores take
/// what they need around each feature from L2. Landmarks that are found become features with the
/// descriptor of the keyframe's, and matches.
/// @param T_predicted  T_world_camera; none if landmarks have no place yet
template <class P>
void align_features(const FrontEndState<P>& state, Frame<P>& frame,
                    const std::optional<Pose<P>>& T_predicted);

}  // namespace leviosim::vio
