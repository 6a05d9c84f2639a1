// Matching of a place's few descriptors with all features of an image: a point of the place takes
// the feature that is nearest, if it is clearly nearer than the second one (ratio test), and if no
// other point of the place is as near to that feature (two-way test). Team fork: "search".
#pragma once

#include "sim/work/machine.h"
#include "workload/vio/loop_options.h"
#include "workload/vision/matcher.h"

namespace leviosim::vio {

/// Fills `out` with features (query) and points of the place (reference), in the order of the
/// points; it needs room for all of them. The caller opens the stage.
/// @param place  8 words for each of `points`
template <class P>
void match_place(work::Machine& machine, const FeatureList<P>& features,
                 typename P::template Span<const typename P::U32> place, int points,
                 const VerificationOptions& options, MatchList<P>& out);

}  // namespace leviosim::vio
