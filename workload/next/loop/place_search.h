// Candidate places for a view: those within the estimate's possible drift that were seen from about
// the same direction, ordered by how similar their signatures are to the view's. Team fork:
// "search".
#pragma once

#include <array>

#include "sim/work/machine.h"
#include "workload/next/loop/place_store.h"
#include "workload/vio/loop_options.h"

namespace leviosim::vio {

/// Where a view was taken, by the present estimate.
template <class P>
struct PlaceQuery {
  Vec3<P> position;                 ///< corrected, m
  Vec3<P> axis;                     ///< of the camera, in the corrected world
  typename P::F32 travelled;        ///< path so far [m]
  typename P::F32 confirmed_at;     ///< path at the last confirmed recognition [m] …
  typename P::F32 confirmed_place;  ///< … and at the place recognised there [m]
  typename P::template Span<typename P::U32> signature;
};

struct PlaceCandidates {
  static constexpr int kMost = 8;
  std::array<int, kMost> places{};  ///< indices of the list, the best first
  int count = 0;
};

/// How far the estimate may have drifted since a place was visited [m]: over the path since then,
/// or, if that is shorter, over the path since the last confirmed recognition and the one from its
/// place to this place.
template <class P>
typename P::F32 drift_gate(const SearchOptions& options, const PlaceQuery<P>& query,
                           typename P::F32 travelled_at_place) {
  using F = typename P::F32;
  const F since = query.travelled - travelled_at_place;
  const F confirmed =
      query.travelled - query.confirmed_at + work::abs(query.confirmed_place - travelled_at_place);
  return F(options.gate_share) * work::min(since, confirmed) + F(options.gate);
}

/// Works inside a stage.
/// @param places    in L1
/// @param features  in L2
template <class P>
PlaceCandidates find_candidates(work::Machine& machine, const PlaceList<P>& places,
                                const PlaceFeatures<P>& features, const PlaceQuery<P>& query,
                                const SearchOptions& options);

}  // namespace leviosim::vio
