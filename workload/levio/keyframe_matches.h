// Matches with the last keyframe, whose features go to L1 whole, however many there are
// (PARAMETERS.md#transfers), and how far they have moved.
#pragma once

#include "workload/vio/frame.h"

namespace leviosim::vio::levio {

/// Matches the frame's features with those of the last keyframe, in the memory that
/// alloc_keyframe_matches() took.
template <class P>
void match_keyframe(const FrontEndState<P>& state, Frame<P>& frame);

/// Sum over the matches of their motion in normalised coordinates; rotation is not undone
/// (PARAMETERS.md#keyframes). Works inside a stage.
template <class P>
typename P::F32 total_motion(const FrontEndState<P>& state, const Frame<P>& frame);

}  // namespace leviosim::vio::levio
