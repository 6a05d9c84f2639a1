// How a map begins: a frame becomes the first keyframe of an empty graph.
#pragma once

#include "workload/vio/frame.h"

namespace leviosim::vio {

/// The first frame: its camera frame is the world, or, for the joint optimiser, one with the same
/// origin whose z axis points up. Gravity is the mean force so far.
template <class P>
void start_map(FrontEndState<P>& state, Frame<P>& frame);

/// A map with the frame as its only keyframe, at frame.T_world_camera and at rest. Works inside a
/// stage.
/// @param record   Preintegration::kFloats in L1, for the motion since this keyframe
/// @param gravity  in the world frame [m/s²]
template <class P>
void begin_map(FrontEndState<P>& state, const Frame<P>& frame,
               typename P::template Span<typename P::F32> record, const ImuBias<P>& bias,
               const Vec3<P>& gravity);

}  // namespace leviosim::vio
