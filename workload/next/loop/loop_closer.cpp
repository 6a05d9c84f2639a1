#include "workload/next/loop/loop_closer.h"

#include <algorithm>

#include "workload/next/loop/densest_place.h"
#include "workload/next/loop/loop_graph.h"
#include "workload/next/loop/view_signature.h"

namespace leviosim::vio {
namespace {

template <class P>
Vec3<P> optical_axis(const Pose<P>& T) {
  return T.R.column(2);
}

/// Whether two views are farther from each other than `distance`, or look in directions with a
/// larger angle than `turn` between them.
template <class P>
bool are_apart(const Pose<P>& a, const Pose<P>& b, float distance, float turn) {
  using F = typename P::F32;
  const Vec3<P> moved = b.t - a.t;
  if (dot(moved, moved) > F(distance * distance)) return true;
  return bool(dot(optical_axis(a), optical_axis(b)) < F(cos_of<work::Native>(turn)));
}

/// Whether two corrections move a position of the odometry to about the same place.
template <class P>
bool are_close(const YawTransform<P>& a, const YawTransform<P>& b, const Vec3<P>& position,
               typename P::F32 distance, typename P::F32 yaw) {
  const Vec3<P> apart = a * position - b * position;
  return dot(apart, apart) < distance * distance && work::abs(wrapped<P>(a.yaw - b.yaw)) < yaw;
}

/// Some of the tracked features, spread evenly over their list, which goes through the image row by
/// row.
template <class P>
typename P::template Span<typename P::U16> choose(work::Arena& local, const LoopView<P>& view,
                                                  int most) {
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  const int number = std::min(most, view.tracked_count);
  const auto chosen = local.alloc<typename P::template Span<U16>>("features of the place", number);
  for (int i : P::range(0, number))
    chosen[i] = work::narrow<U16>(I32(I32(i) * I32(view.tracked_count)) / I32(number));
  return chosen;
}

}  // namespace

template <class P>
LoopCloser<P>::LoopCloser(const LoopOptions& options, const LoopCamera& camera,
                          work::Machine& machine, work::Arena& memory)
    : options_(options),
      camera_(camera),
      machine_(machine),
      places_(memory, options.places, options.graph),
      features_(memory, options.places) {}

template <class P>
LoopOutcome LoopCloser<P>::visit(const LoopView<P>& view) {
  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  PlaceList<P> places(local, options_.places, options_.graph);
  LoopOutcome outcome;
  PlaceQuery<P> query{};
  PlaceCandidates candidates;
  {
    const auto stage = machine_.stage(stages::kPlaceRecognition);
    copy_places_in(machine_, places_, places);
    follow_path(view.T_odometry_camera);
    const Numbers chosen = choose(local, view, options_.places.features);
    const Words signature = local.alloc<Words>("signature", kSignatureWords);
    for (int w : P::range(0, kSignatureWords)) signature[w] = 0u;
    for (int i : P::range(0, chosen.size())) {
      const I32 feature = view.tracked[I32(chosen[i])];
      add_to_signature<P>(
          view.features.descriptors.subspan(I32(feature * I32(kDescriptorWords)), kDescriptorWords),
          signature);
    }
    query = query_of(view, signature);
    if (is_new_place(places, view)) outcome.removed = remember(places, view, chosen, signature);
    if (!has_to_improve())
      candidates = find_candidates(machine_, places, features_, query, options_.search);
  }
  outcome.places = places.count;
  if (candidates.count == 0) return outcome;
  const auto stage = machine_.stage(stages::kLoopVerification);
  const std::optional<Hypothesis> found = only_hypothesis(places, view, query, candidates);
  if (!found || !confirms(*found, view.T_odometry_camera.t)) return outcome;
  confirmed_at_ = travelled_;
  confirmed_place_ = found->place_travelled;
  const ConfirmationOptions& known = options_.confirmation;
  if (are_close(found->T_world_odometry, T_world_odometry_, view.T_odometry_camera.t,
                F(known.known_position), F(known.known_yaw)))
    return outcome;
  add_closure(places, found->closure);
  copy_places_out(machine_, places, places_);
  steps_left_ = options_.graph.steps;
  outcome.closures = 1;
  return outcome;
}

template <class P>
bool LoopCloser<P>::is_due(const Pose<P>& T_odometry_camera) const {
  const SearchOptions& options = options_.search;
  return !last_view_ ||
         are_apart(*last_view_, T_odometry_camera, options.view_distance, options.view_turn);
}

template <class P>
void LoopCloser<P>::follow_path(const Pose<P>& T_odometry_camera) {
  if (last_view_) travelled_ += norm(T_odometry_camera.t - last_view_->t);
  last_view_ = T_odometry_camera;
}

template <class P>
PlaceQuery<P> LoopCloser<P>::query_of(const LoopView<P>& view, Words signature) const {
  return {T_world_odometry_ * view.T_odometry_camera.t,
          turned<P>(sincos_of<P>(T_world_odometry_.yaw), optical_axis(view.T_odometry_camera)),
          travelled_,
          confirmed_at_,
          confirmed_place_,
          signature};
}

/// Farther from the newest place than it need be.
template <class P>
bool LoopCloser<P>::is_new_place(const PlaceList<P>& places, const LoopView<P>& view) const {
  const PlaceOptions& options = options_.places;
  if (view.tracked_count < options.min_features) return false;
  if (places.count == 0) return true;
  return are_apart(places.odometry(places.count - 1), view.T_odometry_camera, options.min_distance,
                   options.min_turn);
}

/// @return whether another place was removed for it
template <class P>
bool LoopCloser<P>::remember(PlaceList<P>& places, const LoopView<P>& view, Numbers chosen,
                             Words signature) {
  using U16 = typename P::U16;
  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  I32 slot = places.count;
  const bool full = places.count == options_.places.places;
  if (full) {
    const I32 gone = densest_place(machine_, places, options_.places.metres_per_rad);
    slot = remove_place(places, work::value(gone));
  }
  const int number = chosen.size();
  const Words descriptors = local.alloc<Words>("descriptors of the place", 8 * number);
  const Numbers points = local.alloc<Numbers>("points of the place", 3 * number);
  for (int i : P::range(0, number)) {
    const I32 tracked = chosen[i];
    const I32 feature = view.tracked[tracked];
    const auto words =
        view.features.descriptors.subspan(I32(feature * I32(kDescriptorWords)), kDescriptorWords);
    for (int w : P::range(0, kDescriptorWords))
      descriptors[kDescriptorWords * i + w] = typename P::U32(words[w]);
    const auto point = view.points.subspan(I32(tracked * I32(3)), 3);
    for (int c = 0; c < 3; ++c)
      points[3 * i + c] = work::narrow<U16>(stored_coordinate<P>(F(point[c])));
  }
  machine_.copy_out(features_.descriptors_of(slot), descriptors);
  machine_.copy_out(features_.points_of(slot), points);
  machine_.copy_out(features_.signature_of(slot), signature);
  const int newest = places.count++;
  places.set_odometry(newest, view.T_odometry_camera);
  places.set_node(newest, {T_world_odometry_.yaw, T_world_odometry_ * view.T_odometry_camera.t});
  places.travelled[newest] = travelled_;
  places.slots[newest] = work::narrow<U16>(slot);
  places.features[newest] = work::narrow<U16>(I32(number));
  copy_places_out(machine_, places, places_);
  return full;
}

/// What the view says about the drift if it shows a place, and gravity and the drift's gate do not
/// contradict.
template <class P>
auto LoopCloser<P>::recognise_at(const PlaceList<P>& places, int place, const LoopView<P>& view,
                                 const PlaceQuery<P>& query) -> std::optional<Hypothesis> {
  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  const I32 slot = places.slots[place];
  StoredView<P> stored;
  stored.count = work::value(I32(places.features[place]));
  const Mat3<P> R_then = places.odometry(place).R;
  stored.descriptors =
      local.alloc<Words>("descriptors of the place", kDescriptorWords * stored.count);
  stored.points =
      local.alloc<typename P::template Span<F>>("points of the place", 3 * stored.count);
  {
    const work::Arena::Frame millimetres(local);
    const Numbers points = local.alloc<Numbers>("points in millimetres", 3 * stored.count);
    machine_.copy_in(stored.descriptors, features_.descriptors_of(slot));
    machine_.copy_in(points, features_.points_of(slot));
    for (int i : P::range(0, stored.count)) {
      const Vec3<P> x{loaded_coordinate<P>(I32(points[3 * i])),
                      loaded_coordinate<P>(I32(points[3 * i + 1])),
                      loaded_coordinate<P>(I32(points[3 * i + 2]))};
      store_vec3<P>(stored.points, 3 * i, R_then * x);
    }
  }
  const Pose<P>& now = view.T_odometry_camera;
  const std::optional<Recognised<P>> seen =
      recognise<P>(machine_, stored, view.features, now.R, camera_, options_.verification, random_);
  if (!seen) return std::nullopt;
  Hypothesis found;
  found.place_travelled = places.travelled[place];
  found.travelled = travelled_;
  found.ambiguous = false;
  Closure<P>& closure = found.closure;
  closure.yaw = -seen->T_view_place.yaw;
  const Vec3<P> to_view = -turned<P>(sincos_of<P>(closure.yaw), seen->T_view_place.t);
  const YawTransform<P> node = places.node(place);
  const F yaw = node.yaw + closure.yaw;
  const Vec3<P> position = node.t + turned<P>(sincos_of<P>(node.yaw), to_view);
  const Vec3<P> off = position - query.position;
  const F gate = drift_gate(options_.search, query, found.place_travelled);
  if (dot(off, off) > gate * gate ||
      work::abs(wrapped<P>(yaw - T_world_odometry_.yaw)) > F(options_.search.gate_yaw))
    return std::nullopt;
  found.T_world_odometry = yaw_transform_between<P>(yaw, now.t, position);
  // The graph binds places: from the view on to the newest of them, the odometry knows the way.
  const int newest = places.count - 1;
  closure.from = place;
  closure.to = newest;
  closure.between =
      to_view + turned<P>(sincos_of<P>(closure.yaw), places.odometry_position(newest) - now.t);
  closure.path = travelled_ - F(places.travelled[newest]);
  return found;
}

/// What the candidates say if they agree, by the one visited first: the estimate has drifted least
/// there.
template <class P>
auto LoopCloser<P>::only_hypothesis(const PlaceList<P>& places, const LoopView<P>& view,
                                    const PlaceQuery<P>& query, const PlaceCandidates& candidates)
    -> std::optional<Hypothesis> {
  std::optional<Hypothesis> first;
  for (int k : P::range(0, candidates.count)) {
    const int place = candidates.places[static_cast<std::size_t>(k)];
    const std::optional<Hypothesis> found = recognise_at(places, place, view, query);
    if (!found) continue;
    const bool ambiguous =
        first && (first->ambiguous || !agree(*first, *found, view.T_odometry_camera.t));
    if (!first || found->place_travelled < first->place_travelled) first = found;
    first->ambiguous = ambiguous;
  }
  return first;
}

/// Whether enough views have said the same of late, and few something else.
template <class P>
bool LoopCloser<P>::confirms(const Hypothesis& hypothesis, const Vec3<P>& position) {
  const ConfirmationOptions& options = options_.confirmation;
  int agreeing = 1, contradicting = 0;
  F first = travelled_;
  for (int i : P::range(0, std::min(recent_count_, kRecent))) {
    const Hypothesis& other = recent_[static_cast<std::size_t>(i)];
    if (travelled_ - other.travelled > F(options.window)) continue;
    if (other.ambiguous || !agree(hypothesis, other, position)) {
      ++contradicting;
    } else {
      ++agreeing;
      first = work::min(first, other.travelled);
    }
  }
  recent_[static_cast<std::size_t>(recent_count_++ % kRecent)] = hypothesis;
  return !hypothesis.ambiguous && agreeing >= options.views && agreeing > 2 * contradicting &&
         travelled_ - first >= F(options.span);
}

/// Whether what two places say differs by no more than the drift between them.
template <class P>
bool LoopCloser<P>::agree(const Hypothesis& a, const Hypothesis& b, const Vec3<P>& position) const {
  const ConfirmationOptions& options = options_.confirmation;
  const F path = work::abs(a.place_travelled - b.place_travelled);
  return are_close(a.T_world_odometry, b.T_world_odometry, position,
                   F(options_.search.gate_share) * path + F(options.position),
                   F(options_.search.yaw_share) * path + F(options.yaw));
}

template <class P>
void LoopCloser<P>::improve() {
  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  const auto stage = machine_.stage(stages::kLoopCorrection);
  PlaceList<P> places(local, options_.places, options_.graph);
  copy_places_in(machine_, places_, places);
  const F moved = improve_nodes(local, places, options_.graph);
  machine_.copy_out(places_.nodes, places.nodes.subspan(0, kNodeFloats * places.count));
  --steps_left_;
  if (moved < F(options_.graph.converged)) steps_left_ = 0;
  const YawTransform<P> newest = places.node(places.count - 1);
  T_world_odometry_ =
      yaw_transform_between<P>(newest.yaw, places.odometry_position(places.count - 1), newest.t);
  closed_ = true;
  time_left_ = options_.smoothing;
}

template <class P>
void LoopCloser<P>::expect_another_map() {
  travelled_ += F(options_.restart_travelled);
  recent_count_ = 0;
}

/// In equal parts over the time that is left, of the yaw and of the position of the camera.
template <class P>
Pose<P> LoopCloser<P>::corrected(const Pose<P>& T_odometry_camera, float dt) {
  if (!closed_) return T_odometry_camera;
  const auto stage = machine_.stage(stages::kLoopCorrection);
  if (time_left_ > 0) {
    const F share = time_left_ > dt ? dt / time_left_ : 1.0f;
    time_left_ -= dt;
    const Vec3<P>& position = T_odometry_camera.t;
    const Vec3<P> before = applied_ * position;
    const Vec3<P> missing = T_world_odometry_ * position - before;
    const F yaw = applied_.yaw + share * wrapped<P>(T_world_odometry_.yaw - applied_.yaw);
    applied_ = yaw_transform_between<P>(yaw, position, before + missing * share);
  } else {
    applied_ = T_world_odometry_;
  }
  return applied_ * T_odometry_camera;
}

template class LoopCloser<work::Native>;
template class LoopCloser<work::Counting>;

}  // namespace leviosim::vio
