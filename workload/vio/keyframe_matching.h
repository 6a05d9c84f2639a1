// Matching with the last keyframe, of which L2 holds the features (keyframe_record.h).
#pragma once

#include "workload/vio/frame.h"

namespace leviosim::vio {

/// Room for the matches in L1, for as long as the caller needs them.
template <class P>
void alloc_keyframe_matches(const FrontEndState<P>& state, Frame<P>& frame);

/// Fills frame.matches. Leaves the keyframe's descriptors in L1 above them: the caller frees them
/// when the pose is known (paper, memory table: 8-point).
template <class P>
void match_keyframe(const FrontEndState<P>& state, Frame<P>& frame);

}  // namespace leviosim::vio
