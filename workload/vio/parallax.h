// How far the features have moved since the last keyframe, from which a frame that becomes a
// keyframe is told.
#pragma once

#include "workload/vio/frame.h"
#include "workload/vio/inertial_part.h"

namespace leviosim::vio {

/// Sum over the matches with the last keyframe, in normalised coordinates. Parallax is what remains
/// of the motion of the matches when the rotation since the keyframe is undone: the rotation that
/// the gyro measured, for a wrong pose would look like parallax, and every frame after it would
/// become a keyframe. Only without an IMU it is that of the poses. Works inside a stage.
template <class P>
typename P::F32 total_parallax(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                               const Frame<P>& frame);

}  // namespace leviosim::vio
