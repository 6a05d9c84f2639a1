// Matching with the last keyframe, of which L2 holds the features (front_end_state.h).
#pragma once

#include "workload/vio/frame.h"

namespace leviosim::vio {

/// Room for the matches, for as long as the caller needs them: in L1, or in L2 where L1 has none.
template <class P>
void alloc_keyframe_matches(const FrontEndState<P>& state, Frame<P>& frame);

/// The keyframe's descriptors for matching. In L1, if they have room there beside what the pose of
/// the frame may take; the caller frees them when it is known (paper, memory table: 8-point). Else
/// they pass in tiles. Works inside a stage.
/// @param number  of features that are copied
template <class P>
DescriptorSource<P> keyframe_descriptors(const FrontEndState<P>& state, int number);

/// What is known of the keyframe's features goes to L1, unless it is read from L2.
/// @param number  of features that are copied
template <class P>
void copy_keyframe_features(const FrontEndState<P>& state, int number,
                            const KeyframeMatches<P>& to);

/// Fills frame.matches, and leaves the keyframe's descriptors in L1 above them.
template <class P>
void match_keyframe(const FrontEndState<P>& state, Frame<P>& frame);

}  // namespace leviosim::vio
