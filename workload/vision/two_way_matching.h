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
#include "sim/work/tiles.h"
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

/// Which of the reference descriptors are there, and what is done with what they come to.
template <class P>
struct ReferenceTile {
  DescriptorWords<P> words;
  int count;
  int first = 0;       ///< number of the first of them
  bool begins = true;  ///< none was there before
  bool ends = true;    ///< none will follow
};

/// The reference descriptor nearest to `held`, if one is closer than `nearest`; else that.
template <class P, class Comparison>
LEVIOSIM_HOST_INLINE Nearest<P> find_nearest(const HeldDescriptor<P>& held,
                                             const ReferenceTile<P>& reference,
                                             Nearest<P> nearest) {
  using I = typename P::I32;
  for (int r : P::range(0, reference.count)) {
    const I distance = Comparison::template distance<P>(held, reference.words, r);
    if (work::unlikely(distance < nearest.distance)) nearest = {r + reference.first, distance};
  }
  return nearest;
}

/// Appends the matches of the current features of `share` to `list`, from share.begin on.
/// @param current  descriptors, of which the first is that of feature `first`
/// @param nearest_so_far  of each feature, in the references that were there before
/// @return how many there are
template <class P, class Comparison>
LEVIOSIM_HOST_CLONES typename P::I32 search(DescriptorWords<P> current, int first,
                                            work::Share share, const ReferenceTile<P>& reference,
                                            const MatcherOptions& options,
                                            const MatchList<P>& nearest_so_far,
                                            const MatchList<P>& list) {
  using I = typename P::I32;
  using U16 = typename P::U16;
  const typename P::Function function(Comparison::kFunction);
  const I limit = options.max_distance;
  const typename P::OffloadRegion kernel(work::OffloadKind::Hamming,
                                         (share.end - share.begin) * reference.count);
  I next = first + share.begin;
  for (int i : P::range(share.begin, share.end)) {
    Nearest<P> nearest = {0, limit};
    if (!reference.begins)
      nearest = {nearest_so_far.reference[first + i], nearest_so_far.distance[first + i]};
    nearest = find_nearest<P, Comparison>(hold_descriptor<P>(current, i), reference, nearest);
    if (!reference.ends) {
      nearest_so_far.reference[first + i] = work::narrow<U16>(nearest.reference);
      nearest_so_far.distance[first + i] = work::narrow<U16>(nearest.distance);
    } else if (nearest.distance < limit) {
      put<P>(list, next, {I(first + i), nearest.reference, nearest.distance});
      next += I(1);
    }
  }
  return next - I(first + share.begin);
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

/// Forks a team whose cores append to slices of `list` for items from `first` on, and closes the
/// gaps behind the matches that it has.
template <class P, class Append>
void append_in_parallel(work::Machine& machine, std::string_view name, int first, int items,
                        typename P::template Span<typename P::I32> kept, MatchList<P>& list,
                        Append&& append) {
  machine.fork(name, [&](work::Core& core) { kept[core.id] = append(core.share(items)); });
  const int before = list.count;
  const auto move = [&](int to, int from) {
    put<P>(list, before + to, match_at<P>(list, first + from));
  };
  list.count += compact_slices<P>(items, 1, kept, move, first > before);
}

/// Calls visit(words, first, count) for all descriptors, or for one tile of them after the other.
/// @param again  with room they would be in local memory already
template <class P, class Visit>
void for_descriptors(work::Machine& machine, const DescriptorSource<P>& from, Bytes room,
                     bool again, Visit&& visit) {
  if (!from.in_l2) return visit(from.words, 0, from.count);
  const work::PassingBlock<P, typename P::U32> block{from.name, from.words, kDescriptorWords,
                                                     again};
  const work::TilePlan plan = work::plan_tiles(machine.local(), from.name, from.count, block.item(),
                                               machine.local().free() - room);
  work::for_each_tile<P>(
      machine, plan,
      [&](int, const work::Tile& tile, DescriptorWords<P> words) {
        visit(words, tile.begin, tile.size());
      },
      block);
}

/// match_sources() (matcher.h) with `Comparison`.
template <class P, class Comparison>
void match(work::Machine& machine, const DescriptorSource<P>& current,
           const DescriptorSource<P>& reference, const MatcherOptions& options, MatchList<P>& out) {
  check(out.capacity >= current.count, "the match list has room for every current feature");
  work::Arena& memory = machine.local();
  const work::EitherFrame frame(machine);
  // As long as the list that comes out; where half of the room would go, as there are features.
  const bool is_short = Bytes(12LL * out.capacity) > memory.free();
  MatchList<P> one_way =
      alloc_matches<P>(machine, is_short ? current.count : out.capacity, "one-way matches");
  const auto kept =
      memory.alloc<typename P::template Span<typename P::I32>>("matches per core", machine.cores());
  // Where both pass in tiles, each has half of the room.
  const Bytes all = memory.free();
  const Bytes part = current.in_l2 && reference.in_l2 ? Bytes(all.count() / 2) : all;
  const auto search_in = [&](DescriptorWords<P> words, int first, int count,
                             const ReferenceTile<P>& tile) {
    const auto in_share = [&](work::Share share) {
      return search<P, Comparison>(words, first, share, tile, options, out, one_way);
    };
    if (tile.ends)
      append_in_parallel<P>(machine, "search", first, count, kept, one_way, in_share);
    else
      machine.fork("search", [&](work::Core& core) { in_share(core.share(count)); });
  };
  for_descriptors<P>(machine, current, part, true,
                     [&](DescriptorWords<P> words, int first, int count) {
                       for_descriptors<P>(machine, reference, part, first > 0,
                                          [&](DescriptorWords<P> of, int first_of, int count_of) {
                                            search_in(words, first, count,
                                                      {of, count_of, first_of, first_of == 0,
                                                       first_of + count_of == reference.count});
                                          });
                     });
  out.count = 0;
  append_in_parallel<P>(
      machine, "two-way filter", 0, one_way.count, kept, out,
      [&](work::Share share) { return keep_uncontested<P>(one_way, share, out); });
}

}  // namespace leviosim::vio::two_way
