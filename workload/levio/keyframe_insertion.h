// Insertion of a keyframe into the map as the released program does it
// (PARAMETERS.md#triangulation): every match without a landmark at either end is triangulated and
// tested in both views, by the master alone. The map and the keyframe go whole, however full they
// are.
#pragma once

#include "workload/vio/frame.h"

namespace leviosim::vio::levio {

/// Puts the frame, whose pose is known, into the graph, and its features into the place of the last
/// keyframe's.
template <class P>
void insert_keyframe(FrontEndState<P>& state, Frame<P>& frame);

}  // namespace leviosim::vio::levio
