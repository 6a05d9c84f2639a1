// What a frame that becomes a keyframe leaves behind: a keyframe in the pose graph, observations of
// known landmarks, and new landmarks triangulated with the keyframe before (paper III.B.5–6).
#include "workload/geometry/triangulate.h"
#include "workload/vio/front_end.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {

template <class P>
void FrontEnd<P>::insert_keyframe(Frame& frame) {
  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  const auto stage = machine_.stage(stages::kTriangulation);
  const PoseGraph<P> graph(local, graph_.capacity);
  const auto interval = local.alloc<Span<F>>("IMU interval", Preintegration<P>::kFloats);
  copy_graph_in<P>(machine_, graph, graph_);
  machine_.copy_in(interval, keyframe_.interval);

  const KeyframeState<P> state{frame.T_world_camera,
                               velocity_at(frame.T_world_camera, graph, interval)};
  const I32 previous = graph.newest_keyframe();
  graph.age_landmarks();
  const I32 slot = graph.add_keyframe(state, interval);
  register_observations(frame, graph, slot);
  triangulate_landmarks(frame, graph, previous, slot);

  Preintegration<P>(interval).reset(graph.bias());
  machine_.copy_out(keyframe_.interval, interval);
  copy_graph_out<P>(machine_, graph_, graph);
  store_keyframe(frame);
}

/// Velocity of the camera in the world: the last keyframe's, carried on by the IMU; without an IMU,
/// the mean since the last keyframe.
template <class P>
Vec3<P> FrontEnd<P>::velocity_at(const Pose<P>& T_world_camera, const PoseGraph<P>& graph,
                                 Span<F> interval) const {
  const KeyframeState<P> last = graph.keyframe(graph.newest_keyframe());
  if (!profile_.use_imu) {
    const F dt = std::max(time_since_keyframe_, 1e-3f);
    return (T_world_camera.t - last.T_world_camera.t) * F(F(1.0f) / dt);
  }
  const ImuDelta<P> delta = Preintegration<P>(interval).corrected(graph.bias());
  return last.velocity + graph.gravity() * delta.dt + last.T_world_camera.R * delta.v;
}

/// Not so old that it is skipped, as those are that have retired.
template <class P>
bool FrontEnd<P>::is_in_use(const PoseGraph<P>& graph, I32 landmark) const {
  return bool(I32(graph.ages[landmark]) <= I32(profile_.max_landmark_age));
}

/// Landmarks that were recognised, directly or through the features of the last keyframe.
template <class P>
void FrontEnd<P>::register_observations(const Frame& frame, const PoseGraph<P>& graph, I32 slot) {
  const typename P::Function function("register_observations");
  const FeatureList<P>& features = frame.features.list;
  for (int i : P::range(0, frame.keyframe_matches.count)) {
    const I32 feature = frame.keyframe_matches.query[i];
    const I32 known = frame.features.landmarks[feature];
    if (known != I32(kNoLandmark)) continue;
    const I32 old = frame.keyframe_matches.reference[i];
    const I32 landmark = frame.keyframe_landmarks[old];
    if (landmark == I32(kNoLandmark) || !is_in_use(graph, landmark)) continue;
    frame.features.landmarks[feature] = work::narrow<U16>(landmark);
  }
  const Pose<P> T_camera_world = inverse(frame.T_world_camera);
  for (int i : P::range(0, features.count)) {
    const I32 landmark = frame.features.landmarks[i];
    if (landmark == I32(kNoLandmark)) continue;
    const I32 age = graph.ages[landmark];
    const I32 u = features.x[i];
    const I32 v = features.y[i];
    const Vec2<P> seen = normalised(u, v);
    const bool seen_already = bool(age == I32(0));
    if (seen_already || !agrees_with_view<P>(T_camera_world, graph.point(landmark), seen,
                                             rig_.camera, profile_.max_observation_error_sq)) {
      frame.features.landmarks[i] = work::narrow<U16>(I32(kNoLandmark));
      continue;
    }
    if (graph.add_observation(slot, landmark, u, v))
      graph.update_descriptor(landmark,
                              features.descriptors.subspan(kDescriptorWords * i, kDescriptorWords));
  }
}

/// Matches that show no landmark yet become one, if both views agree on it and tell how far it is.
template <class P>
void FrontEnd<P>::triangulate_landmarks(const Frame& frame, const PoseGraph<P>& graph,
                                        I32 previous_slot, I32 slot) {
  const typename P::Function function("triangulate_landmarks");
  const Pose<P> T_now = inverse(frame.T_world_camera);
  const Pose<P> T_old = inverse(graph.keyframe(previous_slot).T_world_camera);
  const int old_v = keyframe_.features.list.capacity;
  for (int i : P::range(0, frame.keyframe_matches.count)) {
    const I32 feature = frame.keyframe_matches.query[i];
    const I32 old = frame.keyframe_matches.reference[i];
    if (I32(frame.features.landmarks[feature]) != I32(kNoLandmark)) continue;
    const I32 known = frame.keyframe_landmarks[old];
    if (known != I32(kNoLandmark) && is_in_use(graph, known)) continue;
    const I32 u = frame.features.list.x[feature], v = frame.features.list.y[feature];
    const I32 old_u = frame.keyframe_pixels[old];
    const I32 old_w = frame.keyframe_pixels[I32(old + I32(old_v))];
    const Vec2<P> now = normalised(u, v), before = normalised(old_u, old_w);
    const float limit = profile_.max_landmark_error_sq;
    if (agrees_with_infinity<P>(T_old, T_now, before, now, rig_.camera, limit)) continue;
    const Triangulated<P> point = triangulate<P>(T_old, T_now, before, now, machine_.local());
    if (!point.valid || !agrees_with_view<P>(T_old, point.point, before, rig_.camera, limit) ||
        !agrees_with_view<P>(T_now, point.point, now, rig_.camera, limit))
      continue;
    const auto words = frame.features.list.descriptors.subspan(
        work::value(I32(feature * I32(kDescriptorWords))), kDescriptorWords);
    const I32 landmark = graph.add_landmark(point.point, words);
    if (landmark < I32(0)) return;
    graph.add_observation(previous_slot, landmark, old_u, old_w);
    graph.add_observation(slot, landmark, u, v);
    frame.features.landmarks[feature] = work::narrow<U16>(landmark);
  }
}

/// The frame's features take the place of the last keyframe's.
template <class P>
void FrontEnd<P>::store_keyframe(const Frame& frame) {
  ObservedFeatures<P>& to = keyframe_.features;
  const FeatureList<P>& from = frame.features.list;
  const int n = from.count;
  machine_.copy_out(to.list.x, from.x.subspan(0, n));
  machine_.copy_out(to.list.y, from.y.subspan(0, n));
  machine_.copy_out(to.list.descriptors, from.descriptors.subspan(0, kDescriptorWords * n));
  machine_.copy_out(to.landmarks, frame.features.landmarks.subspan(0, n));
  to.list.count = n;
  time_since_keyframe_ = 0;
}

template class FrontEnd<work::Native>;
template class FrontEnd<work::Counting>;

}  // namespace leviosim::vio
