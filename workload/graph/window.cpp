#include "workload/graph/window.h"

#include "workload/math/solve.h"

namespace leviosim::vio {
namespace {

/// Marks a landmark slot that is not part of the window.
constexpr int kNotInWindow = 0xffff;

/// Tables by landmark slot that are needed while a snapshot is taken.
template <class P>
struct SnapshotTables {
  template <class T>
  using Span = typename P::template Span<T>;

  SnapshotTables(work::Arena& arena, int landmarks)
      : window_index(arena.alloc<Span<typename P::U16>>("snapshot: window index", landmarks)),
        seen(arena.alloc<Span<typename P::Byte>>("snapshot: times seen", landmarks)) {}

  Span<typename P::U16> window_index;
  Span<typename P::Byte> seen;
};

/// Whether observation o means the landmark that holds its slot now.
template <class P>
typename P::Bool is_current(const PoseGraph<P>& graph, int o, typename P::I32 slot) {
  using I32 = typename P::I32;
  return I32(graph.observation_generations[o]) == I32(graph.generations[slot]);
}

/// Adds the uncertainty of gravity to an interval's covariance and factors it.
/// @return false if it is not positive definite
template <class P>
bool factor_covariance(const Preintegration<P>& interval, const ImuNoise& noise) {
  using F = typename P::F32;
  const F dt = interval.duration();
  const F gained = dt * noise.gravity;
  const F fallen = gained * dt * F(0.5f);
  const MatrixView<P> covariance = interval.covariance();
  for (int i = 0; i < 3; ++i) {
    covariance(3 + i, 3 + i) += gained * gained;
    covariance(6 + i, 3 + i) += gained * fallen;
    covariance(6 + i, 6 + i) += fallen * fallen;
  }
  return cholesky_factor<P>(covariance);
}

template <class P>
void copy_keyframes(const PoseGraph<P>& graph, const ImuNoise& noise, Window<P>& window) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  window.keyframes = work::value(graph.keyframe_count());
  for (int k : P::range(0, window.keyframes)) {
    const I32 slot = graph.keyframe_slot(k);
    window.keyframe_slots[k] = slot;
    window.keyframe_ids[k] = I32(graph.keyframe_ids[slot]);
    window.state.set_keyframe(k, graph.keyframe(slot));
    if (k == 0) continue;
    const auto from = graph.interval_record(slot);
    const Preintegration<P> interval = window.interval(k);
    const auto to = interval.record();
    for (int i : P::range(0, Preintegration<P>::kFloats)) to[i] = F(from[i]);
    if (!(interval.duration() > 0.0f)) continue;
    if (!factor_covariance<P>(interval, noise)) interval.clear();
  }
  if (window.keyframes > 0) window.anchor = window.state.keyframe(0);
}

template <class P>
void count_observations(const PoseGraph<P>& graph, const SnapshotTables<P>& tables) {
  using I32 = typename P::I32;
  for (int i : P::range(0, graph.capacity.landmarks))
    tables.seen[i] = work::narrow<typename P::Byte>(I32(0));
  for (int o : P::range(0, work::value(graph.observation_count()))) {
    const I32 slot = graph.observation_landmarks[o];
    if (is_current<P>(graph, o, slot))
      tables.seen[slot] = work::narrow<typename P::Byte>(I32(tables.seen[slot]) + I32(1));
  }
}

/// Gives the landmarks that are seen twice a place in the window, and room for their observations.
template <class P>
void copy_landmarks(const PoseGraph<P>& graph, const SnapshotTables<P>& tables, Window<P>& window) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  using Byte = typename P::Byte;
  I32 landmarks = 0, observations = 0;
  for (int slot : P::range(0, graph.capacity.landmarks)) {
    const I32 seen = tables.seen[slot];
    if (seen < I32(2)) {
      tables.window_index[slot] = work::narrow<U16>(I32(kNotInWindow));
      continue;
    }
    tables.window_index[slot] = work::narrow<U16>(landmarks);
    window.landmark_slots[landmarks] = work::narrow<U16>(I32(slot));
    window.landmark_generations[landmarks] = work::narrow<Byte>(I32(graph.generations[slot]));
    window.first_observations[landmarks] = work::narrow<U16>(observations);
    window.observation_numbers[landmarks] = work::narrow<Byte>(I32(0));
    window.lost[landmarks] = work::narrow<Byte>(I32(0));
    const auto point = window.state.points.subspan(I32(landmarks * I32(3)), 3);
    for (int c = 0; c < 3; ++c) point[c] = F(graph.points[3 * slot + c]);
    observations += seen;
    ++landmarks;
  }
  window.landmarks = work::value(landmarks);
}

/// A landmark's observations come out in the order of the keyframes, since the graph lists them so;
/// one that does not fit this order is left out.
template <class P>
void sort_observations(const PoseGraph<P>& graph, const SnapshotTables<P>& tables,
                       const Window<P>& window) {
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  using Byte = typename P::Byte;
  const I32 oldest = graph.keyframe_slot(0);
  for (int o : P::range(0, work::value(graph.observation_count()))) {
    const I32 slot = graph.observation_landmarks[o];
    const I32 landmark = tables.window_index[slot];
    if (landmark == I32(kNotInWindow)) continue;
    if (!is_current<P>(graph, o, slot)) continue;
    I32 keyframe = I32(graph.observation_keyframes[o]) - oldest;
    if (keyframe < I32(0)) keyframe += I32(graph.capacity.keyframes);
    const I32 number = window.observation_numbers[landmark];
    const I32 at = I32(window.first_observations[landmark]) + number;
    if (number > I32(0)) {
      const I32 before = window.observation_keyframes[I32(at - I32(1))];
      if (keyframe <= before) continue;
    }
    window.observation_keyframes[at] = work::narrow<Byte>(keyframe);
    window.observation_u[at] = work::narrow<U16>(I32(graph.observation_u[o]));
    window.observation_v[at] = work::narrow<U16>(I32(graph.observation_v[o]));
    window.observation_numbers[landmark] = work::narrow<Byte>(I32(number + I32(1)));
  }
}

}  // namespace

template <class P>
Window<P>::Window(work::Arena& arena, const GraphCapacity& size) : capacity(size) {
  const auto allocate = [&](auto& span, std::string_view name, int n) {
    span = arena.alloc<std::remove_reference_t<decltype(span)>>(name, n);
  };
  allocate(state.poses, "window poses", kPoseFloats * size.keyframes);
  allocate(state.velocities, "window velocities", 3 * size.keyframes);
  allocate(state.points, "window points", 3 * size.landmarks);
  allocate(intervals, "window IMU intervals", Preintegration<P>::kFloats * size.keyframes);
  allocate(keyframe_slots, "window keyframe slots", size.keyframes);
  allocate(keyframe_ids, "window keyframe numbers", size.keyframes);
  allocate(landmark_slots, "window landmark slots", size.landmarks);
  allocate(first_observations, "window first observations", size.landmarks);
  allocate(observation_u, "window observed u", size.observations);
  allocate(observation_v, "window observed v", size.observations);
  allocate(observation_keyframes, "window observing keyframes", size.observations);
  allocate(observation_numbers, "window observation numbers", size.landmarks);
  allocate(landmark_generations, "window landmark generations", size.landmarks);
  allocate(lost, "window lost landmarks", size.landmarks);
}

template <class P>
void absorb_departed_intervals(const Window<P>& window, const PoseGraph<P>& graph,
                               const ImuNoise& noise, const BiasOptions& options) {
  using I32 = typename P::I32;
  const typename P::Function function("absorb_departed_intervals");
  const I32 oldest = graph.keyframe_ids[graph.keyframe_slot(0)];
  BiasEstimator<P> estimator(window.bias, window.gravity, noise);
  int departed = 0;
  for (int k : P::range(1, window.keyframes)) {
    if (I32(window.keyframe_ids[k]) > oldest) break;
    estimator.add(window.interval(k), window.state.keyframe(k - 1), window.state.keyframe(k));
    ++departed;
  }
  if (departed > 0) graph.set_bias_prior(estimator.absorb(options, graph.bias_prior(), noise));
}

template <class P>
void take_snapshot(const PoseGraph<P>& graph, const ImuNoise& noise, work::Arena& arena,
                   Window<P>& window) {
  const typename P::Function function("take_snapshot");
  const work::Arena::Frame frame(arena);
  const SnapshotTables<P> tables(arena, graph.capacity.landmarks);
  window.bias = graph.bias();
  window.bias_prior = graph.bias_prior();
  window.bias_is_new = false;
  window.gravity = graph.gravity();
  copy_keyframes<P>(graph, noise, window);
  count_observations<P>(graph, tables);
  copy_landmarks<P>(graph, tables, window);
  sort_observations<P>(graph, tables, window);
}

template <class P>
void publish(const Window<P>& window, const PoseGraph<P>& graph) {
  using I32 = typename P::I32;
  const typename P::Function function("publish");
  for (int k : P::range(0, window.keyframes)) {
    const I32 slot = window.keyframe_slots[k];
    if (I32(graph.keyframe_ids[slot]) != I32(window.keyframe_ids[k])) continue;
    graph.set_keyframe(slot, window.state.keyframe(k));
  }
  for (int i : P::range(0, window.landmarks)) {
    const I32 slot = window.landmark_slots[i];
    if (I32(graph.generations[slot]) != I32(window.landmark_generations[i])) continue;
    if (I32(window.lost[i]) != I32(0)) {
      graph.retire_landmark(slot);
      continue;
    }
    graph.set_point(slot, load_vec3<P>(window.state.points, 3 * i));
  }
  if (window.bias_is_new) graph.set_bias(window.bias);
}

template <class P>
void estimate_biases(Window<P>& window, const ImuNoise& noise, const BiasOptions& options) {
  const typename P::Function function("estimate_biases");
  BiasEstimator<P> estimator(window.bias, window.gravity, noise);
  for (int k : P::range(1, window.keyframes))
    estimator.add(window.interval(k), window.state.keyframe(k - 1), window.state.keyframe(k));
  window.bias = estimator.solve(options, window.bias_prior);
  window.bias_is_new = true;
}

#define LEVIOSIM_INSTANTIATE(P)                                                                   \
  template struct Window<P>;                                                                      \
  template void absorb_departed_intervals(const Window<P>&, const PoseGraph<P>&, const ImuNoise&, \
                                          const BiasOptions&);                                    \
  template void take_snapshot(const PoseGraph<P>&, const ImuNoise&, work::Arena&, Window<P>&);    \
  template void publish(const Window<P>&, const PoseGraph<P>&);                                   \
  template void estimate_biases(Window<P>&, const ImuNoise&, const BiasOptions&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
