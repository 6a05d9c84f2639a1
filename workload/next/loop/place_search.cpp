#include "workload/next/loop/place_search.h"

#include <algorithm>

#include "sim/base/check.h"
#include "workload/next/loop/place_matching.h"
#include "workload/next/loop/view_signature.h"
#include "workload/vision/slices.h"

namespace leviosim::vio {
namespace {

template <class P>
bool may_show(const PlaceList<P>& places, int i, const PlaceQuery<P>& query,
              const SearchOptions& options, float least_cosine) {
  using F = typename P::F32;
  const F travelled = places.travelled[i];
  if (query.travelled - travelled < F(options.min_travelled)) return false;
  const Vec3<P> apart = places.node(i).t - query.position;
  const F gate = drift_gate(options, query, travelled);
  if (dot(apart, apart) > gate * gate) return false;
  return bool(dot(places.axis(i), query.axis) > F(least_cosine));
}

/// Whether two places were visited one after the other, near each other: they say the same.
template <class P>
bool are_neighbours(const PlaceList<P>& places, int a, int b, const SearchOptions& options) {
  using F = typename P::F32;
  const Vec3<P> apart = places.node(a).t - places.node(b).t;
  return dot(apart, apart) < F(options.candidate_distance * options.candidate_distance) &&
         work::abs(F(places.travelled[a]) - F(places.travelled[b])) < F(options.min_travelled);
}

/// The most similar place that is no neighbour of one that was chosen already, or −1.
template <class P>
typename P::I32 next_candidate(const PlaceList<P>& places,
                               typename P::template Span<typename P::I32> scores,
                               const PlaceCandidates& chosen, const SearchOptions& options) {
  using I32 = typename P::I32;
  I32 best = -1, best_score = -1;
  for (int i : P::range(0, places.count)) {
    const I32 score = scores[i];
    if (!(score > best_score)) continue;
    bool is_new = true;
    for (int k : P::range(0, chosen.count)) {
      is_new = !are_neighbours(places, i, chosen.places[static_cast<std::size_t>(k)], options);
      if (!is_new) break;
    }
    if (!is_new) continue;
    best = i;
    best_score = score;
  }
  return best;
}

}  // namespace

template <class P>
PlaceCandidates find_candidates(work::Machine& machine, const PlaceList<P>& places,
                                const PlaceFeatures<P>& features, const PlaceQuery<P>& query,
                                const SearchOptions& options) {
  using I32 = typename P::I32;
  using U32 = typename P::U32;
  using InL2 = typename P::template L2Span<const U32>;
  work::Arena& local = machine.local();
  const work::Arena::Frame memory(local);
  const auto scores =
      local.alloc<typename P::template Span<I32>>("similarities of places", places.count);
  const float least_cosine = cos_of<work::Native>(options.max_angle);
  machine.fork("search", [&](work::Core& core) {
    const auto [first, last] = core.share(places.count);
    for (int i : P::range(first, last)) {
      I32 score = -1;
      if (may_show(places, i, query, options, least_cosine)) {
        const auto signature = features.signature_of(I32(places.slots[i]));
        score = similarity<P>(query.signature, InL2(signature.data(), signature.size()));
      }
      scores[i] = score;
    }
  });
  PlaceCandidates candidates;
  const int most = std::min(options.candidates, PlaceCandidates::kMost);
  for (int k : P::range(0, most)) {
    const I32 next = next_candidate<P>(places, scores, candidates, options);
    if (next < I32(0)) break;
    candidates.places[static_cast<std::size_t>(k)] = work::value(next);
    candidates.count = k + 1;
  }
  return candidates;
}

template PlaceCandidates find_candidates(work::Machine&, const PlaceList<work::Native>&,
                                         const PlaceFeatures<work::Native>&,
                                         const PlaceQuery<work::Native>&, const SearchOptions&);
template PlaceCandidates find_candidates(work::Machine&, const PlaceList<work::Counting>&,
                                         const PlaceFeatures<work::Counting>&,
                                         const PlaceQuery<work::Counting>&, const SearchOptions&);

namespace {

template <class P>
struct NearestTwo {
  typename P::I32 feature, distance, second;
};

template <class P>
NearestTwo<P> nearest_two(const HeldDescriptor<P>& point, const FeatureList<P>& features,
                          typename P::I32 limit) {
  using I32 = typename P::I32;
  NearestTwo<P> nearest{-1, limit, 256};
  for (int f : P::range(0, features.count)) {
    const I32 distance = hamming_distance<P>(point, features.descriptors, f);
    if (work::unlikely(distance < nearest.second)) {
      if (distance < nearest.distance) {
        if (nearest.feature >= I32(0)) nearest.second = nearest.distance;
        nearest.distance = distance;
        nearest.feature = f;
      } else {
        nearest.second = distance;
      }
    }
  }
  return nearest;
}

/// Whether another point of the place is as near to the feature as point `mine`.
template <class P>
bool is_contested(const HeldDescriptor<P>& feature, const DescriptorWords<P>& place, int points,
                  int mine, typename P::I32 distance) {
  using I32 = typename P::I32;
  for (int other : P::range(0, points)) {
    const I32 its = hamming_distance<P>(feature, place, other);
    if (work::unlikely(its <= distance))
      if (I32(other) != I32(mine)) return true;
  }
  return false;
}

/// Appends the matches of the points of `share` to `out`, from share.begin on.
/// @return how many there are
template <class P>
typename P::I32 search(const FeatureList<P>& features, const DescriptorWords<P>& place, int points,
                       const VerificationOptions& options, work::Share share,
                       const MatchList<P>& out) {
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  const typename P::OffloadRegion kernel(work::OffloadKind::Hamming,
                                         (share.end - share.begin) * (features.count + points));
  I32 next = share.begin;
  for (int i : P::range(share.begin, share.end)) {
    const NearestTwo<P> nearest =
        nearest_two<P>(hold_descriptor<P>(place, i), features, I32(options.max_distance));
    if (nearest.feature < I32(0)) continue;
    if (nearest.distance * I32(100) > nearest.second * I32(options.ratio_percent)) continue;
    const auto feature = hold_descriptor<P>(features.descriptors, nearest.feature);
    if (is_contested<P>(feature, place, points, i, nearest.distance)) continue;
    out.query[next] = work::narrow<U16>(nearest.feature);
    out.reference[next] = work::narrow<U16>(I32(i));
    out.distance[next] = work::narrow<U16>(nearest.distance);
    next += I32(1);
  }
  return next - I32(share.begin);
}

}  // namespace

template <class P>
void match_place(work::Machine& machine, const FeatureList<P>& features, DescriptorWords<P> place,
                 int points, const VerificationOptions& options, MatchList<P>& out) {
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  check(out.capacity >= points, "the match list has room for every point of the place");
  const work::Arena::Frame memory(machine.local());
  const auto kept =
      machine.local().alloc<typename P::template Span<I32>>("matches per core", machine.cores());
  machine.fork("search", [&](work::Core& core) {
    kept[core.id] = search<P>(features, place, points, options, core.share(points), out);
  });
  out.count = compact_slices<P>(points, 1, kept, [&](int to, int from) {
    out.query[to] = work::narrow<U16>(I32(out.query[from]));
    out.reference[to] = work::narrow<U16>(I32(out.reference[from]));
    out.distance[to] = work::narrow<U16>(I32(out.distance[from]));
  });
}

template void match_place<work::Native>(work::Machine&, const FeatureList<work::Native>&,
                                        DescriptorWords<work::Native>, int,
                                        const VerificationOptions&, MatchList<work::Native>&);
template void match_place<work::Counting>(work::Machine&, const FeatureList<work::Counting>&,
                                          DescriptorWords<work::Counting>, int,
                                          const VerificationOptions&, MatchList<work::Counting>&);

}  // namespace leviosim::vio
