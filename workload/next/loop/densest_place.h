// What is removed when all places are taken: where places lie densest. Of the two places that are
// nearest to each other, by position and by viewing direction, the later one goes. So what was seen
// first stays, where drift is least, and the number of places is spread over the room that the
// flight covers and does not grow with the time spent in it.
//
// Closures of the place that goes are handed to the place visited before it, moved by the odometry
// between the two, whose drift adds to their error. A closure whose ends meet is void.
#pragma once

#include "workload/next/loop/place_store.h"

namespace leviosim::vio {

/// The place to remove, never the first or the newest. There must be three places.
/// @param places  in L1
template <class P>
typename P::I32 densest_place(work::Machine& machine, const PlaceList<P>& places,
                              float metres_per_rad);

/// Takes place `gone` out of the list.
/// @return its slot
template <class P>
typename P::I32 remove_place(PlaceList<P>& places, int gone);

}  // namespace leviosim::vio
