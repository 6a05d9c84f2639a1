// Features placed between pixels: those that match the last keyframe's are moved to where the
// patches around them agree with it (patch_alignment.h), and landmarks that the keyframe saw, but
// the detector has not found again, are looked for where the camera's pose predicts them.
#pragma once

#include <optional>

#include "workload/vio/frame.h"

namespace leviosim::vio {

/// Works in a stage of its own. Of images of which two have no room in local memory, the cores take
/// what they need around each feature from L2. Landmarks that are found become features with the
/// descriptor of the keyframe's, and matches.
/// @param T_predicted  T_world_camera; none if landmarks have no place yet
template <class P>
void align_features(const FrontEndState<P>& state, Frame<P>& frame,
                    const std::optional<Pose<P>>& T_predicted);

}  // namespace leviosim::vio
