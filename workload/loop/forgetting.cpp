#include "workload/loop/forgetting.h"

#include "sim/base/check.h"

namespace leviosim::vio {
namespace {

/// Where a place is and looks, one row of six floats each, in metres.
template <class P>
void describe_views(const PlaceList<P>& places, float metres_per_rad,
                    typename P::template Span<typename P::F32> views) {
  using F = typename P::F32;
  for (int i : P::range(0, places.count)) {
    store_vec3<P>(views, 6 * i, places.node(i).t);
    store_vec3<P>(views, 6 * i + 3, places.axis(i) * F(metres_per_rad));
  }
}

template <class P>
struct Crowded {
  typename P::I32 place;
  typename P::F32 distance_sq;  ///< to the nearest place before it
};

/// Among places first … last − 1, the one nearest to a place before it.
template <class P>
Crowded<P> most_crowded(typename P::template Span<const typename P::F32> views, int first,
                        int last) {
  using F = typename P::F32;
  Crowded<P> most{-1, 1e30f};
  for (int i : P::range(first, last)) {
    F view[6];
    for (int c = 0; c < 6; ++c) view[c] = views[6 * i + c];
    for (int other : P::range(0, i)) {
      F distance_sq = 0.0f;
      for (int c = 0; c < 6; ++c) {
        const F d = view[c] - F(views[6 * other + c]);
        distance_sq += d * d;
      }
      if (work::unlikely(distance_sq < most.distance_sq)) most = {i, distance_sq};
    }
  }
  return most;
}

/// What is left of a closure when place `gone`, which is not the first, is taken out.
template <class P>
Closure<P> handed_on(const PlaceList<P>& places, Closure<P> closure, int gone) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const auto earlier = [&](I32 place) { return place >= I32(gone) ? I32(place - I32(1)) : place; };
  const bool from = bool(closure.from == I32(gone)), to = bool(closure.to == I32(gone));
  if (from || to) {
    const Vec3<P> back = places.odometry_position(gone - 1) - places.odometry_position(gone);
    // The odometry at `to` is turned against that at `from`.
    if (from) closure.between = closure.between - back;
    if (to) closure.between = closure.between + turned<P>(sincos_of<P>(closure.yaw), back);
    closure.path += F(places.travelled[gone]) - F(places.travelled[gone - 1]);
  }
  closure.from = earlier(closure.from);
  closure.to = earlier(closure.to);
  return closure;
}

template <class P>
void hand_on_closures(PlaceList<P>& places, int gone) {
  int kept = 0;
  for (int c : P::range(0, places.closure_count)) {
    const Closure<P> closure = handed_on(places, places.closure(c), gone);
    if (closure.from == closure.to) continue;
    places.set_closure(kept, closure);
    ++kept;
  }
  places.closure_count = kept;
}

}  // namespace

template <class P>
typename P::I32 densest_place(work::Machine& machine, const PlaceList<P>& places,
                              float metres_per_rad) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  check(places.count >= 3, "there is a place between the first and the newest");
  work::Arena& local = machine.local();
  const work::Arena::Frame memory(local);
  const auto views = local.alloc<typename P::template Span<F>>("views of places", 6 * places.count);
  const auto found = local.alloc<typename P::template Span<I32>>("crowded places", machine.cores());
  const auto distances =
      local.alloc<typename P::template Span<F>>("distances of places", machine.cores());
  describe_views(places, metres_per_rad, views);
  machine.fork("nearest pair", [&](work::Core& core) {
    // Place i is compared with i others, so the last core has most of the work.
    const auto [first, last] = core.share(places.count - 2);
    const Crowded<P> most = most_crowded<P>(views, 1 + first, 1 + last);
    found[core.id] = most.place;
    distances[core.id] = most.distance_sq;
  });
  Crowded<P> most{1, 1e30f};
  for (int id : P::range(0, machine.cores()))
    if (F(distances[id]) < most.distance_sq) most = {I32(found[id]), F(distances[id])};
  return most.place;
}

template <class P>
typename P::I32 remove_place(PlaceList<P>& places, int gone) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  check(gone > 0 && gone < places.count, "a place other than the first is taken out");
  const I32 slot = places.slots[gone];
  hand_on_closures(places, gone);
  for (int i : P::range(gone + 1, places.count)) {
    places.set_odometry(i - 1, places.odometry(i));
    places.set_node(i - 1, places.node(i));
    places.travelled[i - 1] = F(places.travelled[i]);
    places.slots[i - 1] = work::narrow<U16>(I32(places.slots[i]));
    places.features[i - 1] = work::narrow<U16>(I32(places.features[i]));
  }
  --places.count;
  return slot;
}

template <class P>
void add_closure(PlaceList<P>& places, const Closure<P>& closure) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const int capacity = places.closure_from.size();
  if (places.closure_count == capacity) {
    int gone = 1;
    F smallest = 1e30f;
    for (int c : P::range(1, capacity)) {
      const F gap = F(places.travelled[I32(places.closure_to[c])]) -
                    F(places.travelled[I32(places.closure_to[c - 1])]);
      if (gap < smallest) {
        smallest = gap;
        gone = c;
      }
    }
    for (int c : P::range(gone + 1, capacity)) places.set_closure(c - 1, places.closure(c));
    --places.closure_count;
  }
  places.set_closure(places.closure_count, closure);
  ++places.closure_count;
}

template work::Native::I32 densest_place(work::Machine&, const PlaceList<work::Native>&, float);
template work::Counting::I32 densest_place(work::Machine&, const PlaceList<work::Counting>&, float);
template work::Native::I32 remove_place(PlaceList<work::Native>&, int);
template work::Counting::I32 remove_place(PlaceList<work::Counting>&, int);
template void add_closure(PlaceList<work::Native>&, const Closure<work::Native>&);
template void add_closure(PlaceList<work::Counting>&, const Closure<work::Counting>&);

}  // namespace leviosim::vio
