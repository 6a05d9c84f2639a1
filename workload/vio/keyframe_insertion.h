// What a frame that becomes a keyframe leaves behind: a keyframe in the pose graph, observations of
// known landmarks, and new landmarks triangulated with the keyframe before (paper III.B.5–6).
#pragma once

#include "workload/vio/frame.h"

namespace leviosim::vio {

/// Puts the frame, whose pose is known, into the graph, and its features into the place of the last
/// keyframe's.
template <class P>
void insert_keyframe(FrontEndState<P>& state, Frame<P>& frame);

/// The frame's features take the place of the last keyframe's. Works inside a stage.
template <class P>
void store_keyframe(FrontEndState<P>& state, const Frame<P>& frame);

}  // namespace leviosim::vio
