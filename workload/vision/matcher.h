// Brute-force two-way matching of binary descriptors (paper section III, "Feature Matching"), two
// team forks: "search" and "two-way filter".
//
// Search: every current feature takes the reference descriptor with the smallest Hamming distance
// below a limit, the first of equals. Two-way filter: a match is dropped if another match claims
// the same reference feature with an equal or better distance, so two equal claims are both dropped
// (PARAMETERS.md#matching). Each core appends to a slice of its own; the master closes the gaps.
// Left out: which landmarks are too old to count, which the pipeline decides afterwards.
#pragma once

#include "sim/work/either.h"
#include "workload/vision/hamming.h"

namespace leviosim::vio {

/// Up to `capacity` matches, of which the first `count` are valid: current feature query[i] is
/// reference feature reference[i], at Hamming distance distance[i]. 6 bytes per match.
template <class P>
struct MatchList {
  typename P::template EitherSpan<typename P::U16> query, reference, distance;
  int count = 0;
  int capacity = 0;
};

/// An empty list in this memory, which holds a third as many matches.
template <class P>
MatchList<P> matches_in(typename P::template EitherSpan<typename P::U16> block) {
  const int capacity = block.size() / 3;
  return {block.subspan(0, capacity), block.subspan(capacity, capacity),
          block.subspan(2 * capacity, capacity), 0, capacity};
}

/// An empty list, one block in `arena`.
template <class P>
MatchList<P> alloc_matches(work::Arena& arena, int capacity, std::string_view name = "matches") {
  using Numbers = typename P::template Span<typename P::U16>;
  return matches_in<P>(arena.alloc<Numbers>(name, 3 * capacity));
}

/// The same, in local memory if it has room there.
template <class P>
MatchList<P> alloc_matches(work::Machine& machine, int capacity,
                           std::string_view name = "matches") {
  return matches_in<P>(work::alloc_either<P, typename P::U16>(machine, name, 3 * capacity));
}

/// Takes off the list what keeps(i) does not hold for. What is left keeps its order.
template <class P, class Keeps>
void keep_matches(MatchList<P>& matches, const Keeps& keeps) {
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  int kept = 0;
  for (int i : P::range(0, matches.count)) {
    if (!keeps(i)) continue;
    matches.query[kept] = work::narrow<U16>(I32(matches.query[i]));
    matches.reference[kept] = work::narrow<U16>(I32(matches.reference[i]));
    matches.distance[kept] = work::narrow<U16>(I32(matches.distance[i]));
    ++kept;
  }
  matches.count = kept;
}

struct MatcherOptions {
  int max_distance = 35;  ///< bits; a match is strictly closer (PARAMETERS.md#matching)
};

/// Descriptors in local memory; or in L2, from where they pass through it in tiles.
template <class P>
struct DescriptorSource {
  DescriptorWords<P> words;  ///< 8 per descriptor
  int count;
  bool in_l2 = false;
  std::string_view name = "descriptors";  ///< of their tiles, in the memory table
};

/// Matches current descriptors to reference descriptors. `out` needs room for current.count
/// matches; they come in the order of the current features. The caller opens the stage. Local
/// memory while it runs: a second list of out.capacity matches, one word per core, and tiles: with
/// current descriptors in tiles the reference descriptors pass once for each of those.
template <class P>
void match_sources(work::Machine& machine, const DescriptorSource<P>& current,
                   const DescriptorSource<P>& reference, const MatcherOptions& options,
                   MatchList<P>& out);

/// The same, with `current_count` current and `reference_count` reference descriptors in local
/// memory.
template <class P>
void match_two_way(work::Machine& machine, DescriptorWords<P> current, int current_count,
                   DescriptorWords<P> reference, int reference_count, const MatcherOptions& options,
                   MatchList<P>& out) {
  match_sources<P>(machine, DescriptorSource<P>{current, current_count},
                   DescriptorSource<P>{reference, reference_count}, options, out);
}

}  // namespace leviosim::vio
