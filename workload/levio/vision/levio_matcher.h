// Two-way matching of binary descriptors as LEVIO's released program does it: sums of bits are
// numbers of 8 bits, which are brought into their range after each word. So a pair takes 41
// instructions with Xpulp, as in the release (PARAMETERS.md#matching).
//
// That it is these 41 is inferred from the sums of 8 bits. If the release loaded the feature's own
// words again for each pair, and brought the sum into range once, it would be as many.
#pragma once

#include "workload/vision/matcher.h"

namespace leviosim::vio::levio {

/// As vio::match_sources(), and with the same results.
template <class P>
void match_sources(work::Machine& machine, const DescriptorSource<P>& current,
                   const DescriptorSource<P>& reference, const MatcherOptions& options,
                   MatchList<P>& out);

/// As vio::match_two_way().
template <class P>
void match_two_way(work::Machine& machine, DescriptorWords<P> current, int current_count,
                   DescriptorWords<P> reference, int reference_count, const MatcherOptions& options,
                   MatchList<P>& out) {
  levio::match_sources<P>(machine, DescriptorSource<P>{current, current_count},
                          DescriptorSource<P>{reference, reference_count}, options, out);
}

}  // namespace leviosim::vio::levio
