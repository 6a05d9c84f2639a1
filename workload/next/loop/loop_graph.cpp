#include "workload/next/loop/loop_graph.h"

#include "sim/base/check.h"
#include "workload/next/loop/densest_place.h"

namespace leviosim::vio {
namespace {

/// Of a path that is shorter, the drift is not known any better [m].
constexpr float kShortestPath = 0.1f;

/// The edges, linearised: first those of the odometry, k → k + 1, then the closures.
template <class P>
class Edges {
 public:
  using F = typename P::F32;
  using I32 = typename P::I32;
  using Floats = typename P::template Span<F>;

  Edges(work::Arena& local, const PlaceList<P>& places)
      : places_(places),
        number_(places.count - 1 + places.closure_count),
        levers_(local.alloc<Floats>("levers of edges", 2 * number_)),
        information_(local.alloc<Floats>("information of edges", 2 * number_)) {}

  /// Also leaves the residuals, times information, in `pull` (4 for every edge).
  void linearise(const LoopGraphOptions& options, Floats pull) const;

  /// y += Jᵀ e of one edge, e in x, y, z, yaw.
  void add_transposed(int edge, const Vec3<P>& e, F e_yaw, Floats y) const {
    const I32 from = I32(begin_of(edge) * I32(kNodeFloats)),
              to = I32(end_of(edge) * I32(kNodeFloats));
    const Floats at = y.subspan(from, kNodeFloats), end = y.subspan(to, kNodeFloats);
    store_vec3<P>(end, 0, load_vec3<P>(end, 0) + e);
    end[3] += e_yaw;
    store_vec3<P>(at, 0, load_vec3<P>(at, 0) - e);
    at[3] -= lever_x(edge) * e.x + lever_y(edge) * e.y + e_yaw;
  }

  /// y = Jᵀ W J x without the first node, which is held.
  void apply(Floats x, Floats y) const;

  /// z = M⁻¹ r, where M is Jᵀ W J of the odometry's edges alone. Both start with the first node.
  void solve_chain(Floats r, Floats z) const;

 private:
  int chain() const { return places_.count - 1; }
  I32 begin_of(int edge) const {
    return edge < chain() ? I32(edge) : I32(places_.closure_from[edge - chain()]);
  }
  I32 end_of(int edge) const {
    return edge < chain() ? I32(edge + 1) : I32(places_.closure_to[edge - chain()]);
  }
  F lever_x(int edge) const { return levers_[2 * edge]; }
  F lever_y(int edge) const { return levers_[2 * edge + 1]; }

  /// What an edge measured, and the path of odometry in it.
  Closure<P> measured(int edge) const {
    if (edge >= chain()) return places_.closure(edge - chain());
    return {edge, edge + 1, places_.odometry_position(edge + 1) - places_.odometry_position(edge),
            0.0f, F(places_.travelled[edge + 1]) - F(places_.travelled[edge])};
  }

  const PlaceList<P>& places_;
  int number_;
  Floats levers_;       ///< derivative of Rz(ψ_i) z by ψ_i: x and y, z has none
  Floats information_;  ///< of position and of yaw
};

template <class P>
void Edges<P>::linearise(const LoopGraphOptions& options, Floats pull) const {
  const F drift_position = options.drift_position * options.drift_position;
  const F drift_yaw = options.drift_yaw * options.drift_yaw;
  for (int edge : P::range(0, number_)) {
    const Closure<P> m = measured(edge);
    const bool closes = edge >= chain();
    const YawTransform<P> from = places_.node(m.from), to = places_.node(m.to);
    const Vec3<P> expected = turned<P>(sincos_of<P>(from.yaw), m.between);
    levers_[2 * edge] = -expected.y;
    levers_[2 * edge + 1] = expected.x;
    F variance = 0.0f, yaw_variance = 0.0f;
    if (closes) {
      variance = options.loop_position * options.loop_position;
      yaw_variance = options.loop_yaw * options.loop_yaw;
    }
    const F path = closes ? m.path : F(work::max(m.path, F(kShortestPath)));
    const F information = F(1.0f) / (drift_position * path + variance);
    const F yaw_information = F(1.0f) / (drift_yaw * path + yaw_variance);
    information_[2 * edge] = information;
    information_[2 * edge + 1] = yaw_information;
    const Vec3<P> r = to.t - from.t - expected;
    store_vec3<P>(pull, 4 * edge, r * information);
    pull[4 * edge + 3] = wrapped<P>(to.yaw - from.yaw - m.yaw) * yaw_information;
  }
}

template <class P>
void Edges<P>::apply(Floats x, Floats y) const {
  for (int i : P::range(0, kNodeFloats * places_.count)) y[i] = 0.0f;
  for (int edge : P::range(0, number_)) {
    const Floats from = x.subspan(I32(begin_of(edge) * I32(kNodeFloats)), kNodeFloats);
    const Floats to = x.subspan(I32(end_of(edge) * I32(kNodeFloats)), kNodeFloats);
    const F yaw = from[3], information = information_[2 * edge];
    Vec3<P> e = load_vec3<P>(to, 0) - load_vec3<P>(from, 0);
    e.x -= lever_x(edge) * yaw;
    e.y -= lever_y(edge) * yaw;
    const F e_yaw = (F(to[3]) - yaw) * F(information_[2 * edge + 1]);
    add_transposed(edge, e * information, e_yaw, y);
  }
  for (int c = 0; c < kNodeFloats; ++c) y[c] = 0.0f;
}

/// With u = W J z: Jᵀ u = r is solved for u from the last node back, J z = W⁻¹ u for z from the
/// first one on. u of the edge that ends in a node lies in that node's place in z.
template <class P>
void Edges<P>::solve_chain(Floats r, Floats z) const {
  Vec3<P> u{0.0f, 0.0f, 0.0f};
  F u_yaw = 0.0f;
  for (int node : P::down_range(chain(), 1)) {
    const int at = kNodeFloats * node;
    if (node < chain()) u_yaw += lever_x(node) * u.x + lever_y(node) * u.y;
    u = u + load_vec3<P>(r, at);
    u_yaw += F(r[at + 3]);
    store_vec3<P>(z, at, u);
    z[at + 3] = u_yaw;
  }
  Vec3<P> x{0.0f, 0.0f, 0.0f};
  F yaw = 0.0f;
  store_vec3<P>(z, 0, x);
  z[3] = yaw;
  for (int edge : P::range(0, chain())) {
    const int at = kNodeFloats * (edge + 1);
    const F inverse = F(1.0f) / F(information_[2 * edge]);
    x = x + load_vec3<P>(z, at) * inverse;
    x.x += lever_x(edge) * yaw;
    x.y += lever_y(edge) * yaw;
    yaw += F(z[at + 3]) / F(information_[2 * edge + 1]);
    store_vec3<P>(z, at, x);
    z[at + 3] = yaw;
  }
}

template <class P>
typename P::F32 product(typename P::template Span<typename P::F32> a,
                        typename P::template Span<typename P::F32> b) {
  using F = typename P::F32;
  F sum = 0.0f;
  for (int i : P::range(0, a.size())) sum += F(a[i]) * F(b[i]);
  return sum;
}

/// a += s b
template <class P>
void add_multiple(typename P::template Span<typename P::F32> a, typename P::F32 s,
                  typename P::template Span<typename P::F32> b) {
  using F = typename P::F32;
  for (int i : P::range(0, a.size())) a[i] = F(F(a[i]) + s * F(b[i]));
}

/// Solves Jᵀ W J x = r by conjugate gradients, until the error has fallen by kGain or for as many
/// iterations as there may be.
template <class P>
void solve(work::Arena& local, const Edges<P>& edges, typename P::template Span<typename P::F32> r,
           int iterations, typename P::template Span<typename P::F32> x) {
  using F = typename P::F32;
  using Floats = typename P::template Span<F>;
  constexpr float kGain = 1e-3f;
  const int n = r.size();
  const Floats z = local.alloc<Floats>("preconditioned residual", n),
               direction = local.alloc<Floats>("direction", n),
               image = local.alloc<Floats>("image of the direction", n);
  for (int i : P::range(0, n)) x[i] = direction[i] = F(0.0f);
  edges.solve_chain(r, z);
  F square = product<P>(r, z);
  const F enough = square * F(kGain * kGain);
  F turn = 0.0f;
  for ([[maybe_unused]] int iteration : P::range(0, iterations)) {
    if (!(square > enough)) break;
    for (int i : P::range(0, n)) direction[i] = F(F(z[i]) + turn * F(direction[i]));
    edges.apply(direction, image);
    const F curvature = product<P>(direction, image);
    if (!(curvature > F(0.0f))) break;
    const F length = square / curvature;
    add_multiple<P>(x, length, direction);
    add_multiple<P>(r, -length, image);
    edges.solve_chain(r, z);
    const F next = product<P>(r, z);
    turn = next / square;
    square = next;
  }
}

}  // namespace

template <class P>
typename P::F32 improve_nodes(work::Arena& local, PlaceList<P>& places,
                              const LoopGraphOptions& options) {
  using F = typename P::F32;
  using Floats = typename P::template Span<F>;
  if (places.count < 2) return 0.0f;
  const work::Arena::Frame memory(local);
  const int n = kNodeFloats * places.count;
  const Edges<P> edges(local, places);
  const Floats residual = local.alloc<Floats>("residual", n),
               change = local.alloc<Floats>("change of nodes", n);
  for (int i : P::range(0, n)) residual[i] = 0.0f;
  {
    const work::Arena::Frame scratch(local);
    const int number = places.count - 1 + places.closure_count;
    const Floats pull = local.alloc<Floats>("pull of edges", 4 * number);
    edges.linearise(options, pull);
    for (int edge : P::range(0, number))
      edges.add_transposed(edge, -load_vec3<P>(pull, 4 * edge), -F(pull[4 * edge + 3]), residual);
    for (int c = 0; c < kNodeFloats; ++c) residual[c] = 0.0f;
  }
  solve<P>(local, edges, residual, options.iterations, change);
  F largest_sq = 0.0f;
  for (int i : P::range(0, places.count)) {
    const YawTransform<P> node = places.node(i);
    const Vec3<P> moved = load_vec3<P>(change, kNodeFloats * i);
    places.set_node(i, {node.yaw + F(change[kNodeFloats * i + 3]), node.t + moved});
    largest_sq = work::max(largest_sq, dot(moved, moved));
  }
  return work::sqrt(largest_sq);
}

template work::Native::F32 improve_nodes(work::Arena&, PlaceList<work::Native>&,
                                         const LoopGraphOptions&);
template work::Counting::F32 improve_nodes(work::Arena&, PlaceList<work::Counting>&,
                                           const LoopGraphOptions&);

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
