#include "workload/loop/place_search.h"

#include <algorithm>

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
    for (int k = 0; k < chosen.count && is_new; ++k)
      is_new = !are_neighbours(places, i, chosen.places[static_cast<std::size_t>(k)], options);
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
  while (candidates.count < most) {
    const I32 next = next_candidate<P>(places, scores, candidates, options);
    if (next < I32(0)) break;
    candidates.places[static_cast<std::size_t>(candidates.count++)] = work::value(next);
  }
  return candidates;
}

template PlaceCandidates find_candidates(work::Machine&, const PlaceList<work::Native>&,
                                         const PlaceFeatures<work::Native>&,
                                         const PlaceQuery<work::Native>&, const SearchOptions&);
template PlaceCandidates find_candidates(work::Machine&, const PlaceList<work::Counting>&,
                                         const PlaceFeatures<work::Counting>&,
                                         const PlaceQuery<work::Counting>&, const SearchOptions&);

}  // namespace leviosim::vio
