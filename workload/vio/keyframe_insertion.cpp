#include "workload/vio/keyframe_insertion.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "workload/geometry/triangulate.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {
namespace {

/// Not so old that it is skipped, as those are that have retired.
template <class P>
bool is_in_use(const FrontEndState<P>& state, const PoseGraph<P>& graph, typename P::I32 landmark) {
  using I32 = typename P::I32;
  return bool(I32(graph.ages[landmark]) <= I32(state.profile.max_landmark_age));
}

/// Landmarks that were recognised, directly or through the features of the last keyframe.
template <class P>
void register_observations(const FrontEndState<P>& state, const Frame<P>& frame,
                           const PoseGraph<P>& graph, typename P::I32 slot, bool aligned) {
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  const typename P::Function function("register_observations");
  const FeatureList<P>& features = frame.features.list;
  for (int i : P::range(0, frame.matches.list.count)) {
    const I32 feature = frame.matches.list.query[i];
    const I32 known = frame.features.landmarks[feature];
    if (known != I32(kNoLandmark)) continue;
    const I32 old = frame.matches.list.reference[i];
    const I32 landmark = frame.matches.landmarks[old];
    if (landmark == I32(kNoLandmark) || !is_in_use(state, graph, landmark)) continue;
    frame.features.landmarks[feature] = work::narrow<U16>(landmark);
  }
  const Pose<P> T_camera_world = inverse(frame.T_world_camera);
  for (int i : P::range(0, features.count)) {
    const I32 landmark = frame.features.landmarks[i];
    if (landmark == I32(kNoLandmark)) continue;
    const I32 age = graph.ages[landmark];
    const I32 u = features.x[i];
    const I32 v = features.y[i];
    const Vec2<P> seen = state.camera.normalised(u, v);
    const bool seen_already = bool(age == I32(0));
    if (seen_already || (aligned && !agrees_with_view<P>(T_camera_world, graph.point(landmark),
                                                         seen, state.rig.camera,
                                                         state.profile.max_observation_error_sq))) {
      frame.features.landmarks[i] = work::narrow<U16>(I32(kNoLandmark));
      continue;
    }
    if (graph.add_observation(slot, landmark, u, v))
      graph.update_descriptor(landmark,
                              features.descriptors.subspan(kDescriptorWords * i, kDescriptorWords));
  }
}

/// The point that two views see, if they agree on it and tell how far it is.
template <class P>
std::optional<Vec3<P>> point_of(const FrontEndState<P>& state, const Pose<P>& T_old,
                                const Pose<P>& T_now, const Vec2<P>& before, const Vec2<P>& now) {
  const PinholeCamera& camera = state.rig.camera;
  const float limit = state.profile.max_landmark_error_sq;
  if (agrees_with_infinity<P>(T_old, T_now, before, now, camera, limit)) return std::nullopt;
  const Triangulated<P> point = triangulate<P>(T_old, T_now, before, now, state.machine.local());
  if (!point.valid || !agrees_with_view<P>(T_old, point.point, before, camera, limit) ||
      !agrees_with_view<P>(T_now, point.point, now, camera, limit))
    return std::nullopt;
  return point.point;
}

/// A point where a view sees it.
template <class P>
Vec3<P> any_point_of(const Pose<P>& T_camera_world, const Vec2<P>& seen, typename P::F32 depth) {
  return inverse(T_camera_world) * Vec3<P>{seen.x * depth, seen.y * depth, depth};
}

/// Matches that show no landmark yet become one.
template <class P>
void add_landmarks(const FrontEndState<P>& state, const Frame<P>& frame, const PoseGraph<P>& graph,
                   typename P::I32 previous_slot, typename P::I32 slot, float any_depth) {
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  const typename P::Function function("triangulate_landmarks");
  const Pose<P> T_now = inverse(frame.T_world_camera);
  const Pose<P> T_old = inverse(graph.keyframe(previous_slot).T_world_camera);
  for (int i : P::range(0, frame.matches.list.count)) {
    const I32 feature = frame.matches.list.query[i];
    const I32 old = frame.matches.list.reference[i];
    if (I32(frame.features.landmarks[feature]) != I32(kNoLandmark)) continue;
    const I32 known = frame.matches.landmarks[old];
    if (known != I32(kNoLandmark) && is_in_use(state, graph, known)) continue;
    const I32 u = frame.features.list.x[feature], v = frame.features.list.y[feature];
    const I32 old_u = frame.matches.u(old), old_v = frame.matches.v(old);
    const Vec2<P> now = state.camera.normalised(u, v),
                  before = state.camera.normalised(old_u, old_v);
    const std::optional<Vec3<P>> point = any_depth == 0
                                             ? point_of<P>(state, T_old, T_now, before, now)
                                             : any_point_of<P>(T_old, before, any_depth);
    if (!point) continue;
    const auto words = frame.features.list.descriptors.subspan(I32(feature * I32(kDescriptorWords)),
                                                               kDescriptorWords);
    const I32 landmark = graph.add_landmark(*point, words);
    if (landmark < I32(0)) return;
    graph.add_observation(previous_slot, landmark, old_u, old_v);
    graph.add_observation(slot, landmark, u, v);
    frame.features.landmarks[feature] = work::narrow<U16>(landmark);
  }
}

}  // namespace

template <class P>
Vec3<P> velocity_at(const FrontEndState<P>& state, const Pose<P>& T_world_camera,
                    const PoseGraph<P>& graph,
                    typename P::template Span<typename P::F32> interval) {
  using F = typename P::F32;
  const KeyframeState<P> last = graph.keyframe(graph.newest_keyframe());
  if (!state.profile.use_imu) {
    const F dt = std::max(state.time_since_keyframe, 1e-3f);  // for a quotient that is finite
    return (T_world_camera.t - last.T_world_camera.t) * F(F(1.0f) / dt);
  }
  const ImuDelta<P> delta = Preintegration<P>(interval).corrected(graph.bias());
  return last.velocity + graph.gravity() * delta.dt + last.T_world_camera.R * delta.v;
}

template <class P>
void insert_keyframe(FrontEndState<P>& state, Frame<P>& frame, float any_depth) {
  using I32 = typename P::I32;
  using Floats = typename P::template Span<typename P::F32>;
  work::Machine& machine = state.machine;
  work::Arena& local = machine.local();
  const work::Arena::Frame memory(local);
  const auto stage = machine.stage(stages::kTriangulation);
  const PoseGraph<P> graph(local, state.graph.capacity);
  const auto interval = local.alloc<Floats>("IMU interval", Preintegration<P>::kFloats);
  copy_graph_in<P>(machine, graph, state.graph);
  machine.copy_in(interval, state.keyframe.interval);

  const KeyframeState<P> newest{frame.T_world_camera,
                                velocity_at(state, frame.T_world_camera, graph, interval)};
  const I32 previous = graph.newest_keyframe();
  graph.age_landmarks();
  const I32 slot = graph.add_keyframe(newest, interval);
  register_observations(state, frame, graph, slot, any_depth == 0);
  add_landmarks(state, frame, graph, previous, slot, any_depth);

  Preintegration<P>(interval).reset(graph.bias());
  machine.copy_out(state.keyframe.interval, interval);
  copy_graph_out<P>(machine, state.graph, graph);
  store_keyframe(state, frame);
}

template <class P>
void store_keyframe(FrontEndState<P>& state, const Frame<P>& frame) {
  work::Machine& machine = state.machine;
  ObservedFeatures<P>& to = state.keyframe.features;
  const FeatureList<P>& from = frame.features.list;
  const int n = from.count;
  machine.copy_out(to.list.x, from.x.subspan(0, n));
  machine.copy_out(to.list.y, from.y.subspan(0, n));
  machine.copy_out(to.list.descriptors, from.descriptors.subspan(0, kDescriptorWords * n));
  machine.copy_out(to.landmarks, frame.features.landmarks.subspan(0, n));
  to.list.count = n;
  // The camera writes the next image to where the one of the keyframe before was.
  if (state.keyframe.seen.width > 0) std::swap(state.keyframe.image, state.keyframe.seen);
  state.time_since_keyframe = 0;
}

template void insert_keyframe(FrontEndState<work::Native>&, Frame<work::Native>&, float);
template void insert_keyframe(FrontEndState<work::Counting>&, Frame<work::Counting>&, float);
template Vec3<work::Native> velocity_at(const FrontEndState<work::Native>&,
                                        const Pose<work::Native>&, const PoseGraph<work::Native>&,
                                        work::Native::Span<work::Native::F32>);
template Vec3<work::Counting> velocity_at(const FrontEndState<work::Counting>&,
                                          const Pose<work::Counting>&,
                                          const PoseGraph<work::Counting>&,
                                          work::Counting::Span<work::Counting::F32>);
template void store_keyframe(FrontEndState<work::Native>&, const Frame<work::Native>&);
template void store_keyframe(FrontEndState<work::Counting>&, const Frame<work::Counting>&);

}  // namespace leviosim::vio
