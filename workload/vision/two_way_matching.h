// What matchers of binary descriptors share: two forks, "search" and "two-way filter" (matcher.h).
// How a feature is compared with a reference is left to a `Comparison`:
//
//   struct Comparison {
//     static constexpr work::CodeName kFunction;  // the name of the search
//     // In how many bits `held` and reference descriptor `r` differ.
//     template <class P>
//     static P::I32 distance(const HeldDescriptor<P>& held, DescriptorWords<P> reference, int r);
//   };
#pragma once

#include "sim/base/check.h"
#include "workload/math/compilers.h"
#include "workload/vision/matcher.h"
#include "workload/vision/slices.h"

namespace leviosim::vio::two_way {

template <class P>
struct Match {
  typename P::I32 query, reference, distance;
};

template <class P>
Match<P> match_at(const MatchList<P>& list, int i) {
  return {list.query[i], list.reference[i], list.distance[i]};
}

template <class P, class Index>
void put(const MatchList<P>& list, Index i, const Match<P>& match) {
  using U16 = typename P::U16;
  list.query[i] = work::narrow<U16>(match.query);
  list.reference[i] = work::narrow<U16>(match.reference);
  list.distance[i] = work::narrow<U16>(match.distance);
}

template <class P>
struct Nearest {
  typename P::I32 reference, distance;
};

/// The reference descriptor nearest to `held`, if one is closer than `limit`; else the distance is
/// `limit`.
template <class P, class Comparison>
LEVIOSIM_HOST_INLINE Nearest<P> find_nearest(const HeldDescriptor<P>& held,
                                             DescriptorWords<P> reference, int count,
                                             typename P::I32 limit) {
  using I = typename P::I32;
  Nearest<P> nearest = {0, limit};
  for (int r : P::range(0, count)) {
    const I distance = Comparison::template distance<P>(held, reference, r);
    if (work::unlikely(distance < nearest.distance)) nearest = {r, distance};
  }
  return nearest;
}

/// Appends the matches of the current features of `share` to `list`, from share.begin on.
/// @return how many there are
template <class P, class Comparison>
LEVIOSIM_HOST_CLONES typename P::I32 search(DescriptorWords<P> current, work::Share share,
                                            DescriptorWords<P> reference, int reference_count,
                                            const MatcherOptions& options,
                                            const MatchList<P>& list) {
  using I = typename P::I32;
  const typename P::Function function(Comparison::kFunction);
  const I limit = options.max_distance;
  const typename P::OffloadRegion kernel(work::OffloadKind::Hamming,
                                         (share.end - share.begin) * reference_count);
  I next = share.begin;
  for (int i : P::range(share.begin, share.end)) {
    const Nearest<P> nearest = find_nearest<P, Comparison>(hold_descriptor<P>(current, i),
                                                           reference, reference_count, limit);
    if (nearest.distance < limit) {
      put<P>(list, next, {I(i), nearest.reference, nearest.distance});
      next += I(1);
    }
  }
  return next - I(share.begin);
}

/// Whether another match claims the reference feature of match `i` at an equal or better distance.
template <class P>
bool is_contested(const MatchList<P>& list, int i) {
  using I = typename P::I32;
  const Match<P> claim = match_at<P>(list, i);
  for (int j : P::range(0, list.count))
    if (I(list.reference[j]) == claim.reference && I(list.distance[j]) <= claim.distance &&
        I(j) != I(i))
      return true;
  return false;
}

/// Appends the uncontested matches of `share` of `one_way` to `list`, from share.begin on.
/// @return how many there are
template <class P>
typename P::I32 keep_uncontested(const MatchList<P>& one_way, work::Share share,
                                 const MatchList<P>& list) {
  using I = typename P::I32;
  const typename P::Function function("keep_uncontested");
  I next = share.begin;
  for (int i : P::range(share.begin, share.end)) {
    if (is_contested<P>(one_way, i)) continue;
    put<P>(list, next, match_at<P>(one_way, i));
    next += I(1);
  }
  return next - I(share.begin);
}

/// Forks a team whose cores append to slices of `list`, and closes the gaps.
template <class P, class Append>
void append_in_parallel(work::Machine& machine, std::string_view name, int items,
                        typename P::template Span<typename P::I32> kept, MatchList<P>& list,
                        Append&& append) {
  machine.fork(name, [&](work::Core& core) { kept[core.id] = append(core.share(items)); });
  list.count = compact_slices<P>(
      items, 1, kept, [&](int to, int from) { put<P>(list, to, match_at<P>(list, from)); });
}

/// match_two_way() (matcher.h) with `Comparison`.
template <class P, class Comparison>
void match(work::Machine& machine, DescriptorWords<P> current, int current_count,
           DescriptorWords<P> reference, int reference_count, const MatcherOptions& options,
           MatchList<P>& out) {
  check(out.capacity >= current_count, "the match list has room for every current feature");
  work::Arena& memory = machine.local();
  const work::Arena::Frame frame(memory);
  MatchList<P> one_way = alloc_matches<P>(memory, out.capacity, "one-way matches");
  const auto kept =
      memory.alloc<typename P::template Span<typename P::I32>>("matches per core", machine.cores());
  append_in_parallel<P>(machine, "search", current_count, kept, one_way, [&](work::Share share) {
    return search<P, Comparison>(current, share, reference, reference_count, options, one_way);
  });
  append_in_parallel<P>(
      machine, "two-way filter", one_way.count, kept, out,
      [&](work::Share share) { return keep_uncontested<P>(one_way, share, out); });
}

}  // namespace leviosim::vio::two_way
