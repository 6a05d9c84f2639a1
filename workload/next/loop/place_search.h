// Which places a view is compared with: those that lie within what the estimate may have drifted
// and that were looked at from about the same direction, those first whose signature is most like
// the view's. Team fork: "search".
#pragma once

#include <array>

#include "sim/work/machine.h"
#include "workload/next/loop/place_store.h"
#include "workload/vio/loop_options.h"

namespace leviosim::vio {

/// A view, by the present estimate.
template <class P>
struct PlaceQuery {
  Vec3<P> position;           ///< corrected, m
  Vec3<P> axis;               ///< of the camera, in the corrected world
  typename P::F32 travelled;  ///< until now, m
  typename P::F32 bound_at;   ///< path until the estimate was last bound to a place, m …
  typename P::F32 bound_to;   ///< … and until that place
  typename P::template Span<typename P::U32> signature;
};

struct PlaceCandidates {
  static constexpr int kMost = 8;
  std::array<int, kMost> places{};  ///< indices of the list, the best first
  int count = 0;
};

/// How far the estimate may have drifted since a place was visited [m]: by the way since then, or
/// from there to the place that it was bound to, and since.
template <class P>
typename P::F32 drift_gate(const SearchOptions& options, const PlaceQuery<P>& query,
                           typename P::F32 travelled_at_place) {
  using F = typename P::F32;
  const F since = query.travelled - travelled_at_place;
  const F bound = query.travelled - query.bound_at + work::abs(query.bound_to - travelled_at_place);
  return F(options.gate_share) * work::min(since, bound) + F(options.gate);
}

/// Works inside a stage.
/// @param places    in L1
/// @param features  in L2
template <class P>
PlaceCandidates find_candidates(work::Machine& machine, const PlaceList<P>& places,
                                const PlaceFeatures<P>& features, const PlaceQuery<P>& query,
                                const SearchOptions& options);

}  // namespace leviosim::vio
