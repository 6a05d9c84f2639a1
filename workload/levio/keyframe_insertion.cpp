#include "workload/levio/keyframe_insertion.h"

#include "workload/levio/geometry/pose_matrix.h"
#include "workload/levio/geometry/two_view_point.h"
#include "workload/levio/keyframe_matches.h"
#include "workload/levio/vision/levio_matcher.h"
#include "workload/vio/graph_at_hand.h"
#include "workload/vio/keyframe_matching.h"
#include "workload/vio/keyframes.h"
#include "workload/vio/stages.h"

namespace leviosim::vio::levio {
namespace {

/// What an insertion works with: the graph, the frame's descriptors, the camera, and where both
/// keyframes are.
template <class P, class Graph, class Words>
struct Insertion {
  using I32 = typename P::I32;

  const FrontEndState<P>& state;
  const Frame<P>& frame;
  const Graph& graph;
  const Words& descriptors;
  CameraConstants<P> camera;
  MatrixView<P> T_before, T_now;  ///< 4×4, from the world
  I32 slot_before, slot_now;

  /// Not so old that it is skipped, as those are that have retired.
  bool is_in_use(I32 landmark) const {
    return bool(I32(graph.ages[landmark]) <= I32(state.profile.max_landmark_age));
  }
  Vec2<P> pixel(I32 u, I32 v) const { return {state.camera.pixel(u), state.camera.pixel(v)}; }
  /// In front of the camera, and near where it was seen.
  bool agrees(MatrixView<P> T, const Vec3<P>& point, const Vec2<P>& seen, float limit) const {
    using F = typename P::F32;
    const F depth = T(2, 0) * point.x + T(2, 1) * point.y + T(2, 2) * point.z + T(2, 3);
    return depth > F(0.0f) && reprojection_error_sq<P>(T, point, seen, camera) < F(limit);
  }
};

/// Features whose match in the last keyframe shows a landmark show it, too.
template <class P, class Graph, class Words>
void inherit_landmarks(const Insertion<P, Graph, Words>& in) {
  using I32 = typename P::I32;
  const typename P::Function function("levio_inherit_landmarks");
  const MatchList<P>& matches = in.frame.matches.list;
  for (int i : P::range(0, matches.count)) {
    const I32 feature = matches.query[i];
    if (I32(in.frame.features.landmarks[feature]) != I32(kNoLandmark)) continue;
    const I32 landmark = in.frame.matches.landmarks[I32(matches.reference[i])];
    if (landmark == I32(kNoLandmark) || !in.is_in_use(landmark)) continue;
    in.frame.features.landmarks[feature] = work::narrow<typename P::U16>(landmark);
  }
}

/// Landmarks that the features show and that agree with them.
template <class P, class Graph, class Words>
void register_observations(const Insertion<P, Graph, Words>& in) {
  using I32 = typename P::I32;
  const typename P::Function function("levio_register_observations");
  const FeatureList<P>& features = in.frame.features.list;
  for (int i : P::range(0, features.count)) {
    const I32 landmark = in.frame.features.landmarks[i];
    if (landmark == I32(kNoLandmark)) continue;
    const I32 u = features.x[i], v = features.y[i];
    const bool seen_already = bool(I32(in.graph.ages[landmark]) == I32(0));
    if (seen_already || !in.agrees(in.T_now, in.graph.point(landmark), in.pixel(u, v),
                                   in.state.profile.max_observation_error_sq)) {
      in.frame.features.landmarks[i] = work::narrow<typename P::U16>(I32(kNoLandmark));
      continue;
    }
    if (in.graph.add_observation(in.slot_now, landmark, u, v))
      in.graph.update_descriptor(landmark,
                                 in.descriptors.subspan(kDescriptorWords * i, kDescriptorWords));
  }
}

/// Matches that show no landmark yet become one, if both views agree on it.
template <class P, class Graph, class Words>
void triangulate_landmarks(const Insertion<P, Graph, Words>& in) {
  using I32 = typename P::I32;
  const typename P::Function function("levio_triangulate_landmarks");
  const Frame<P>& frame = in.frame;
  const MatchList<P>& matches = frame.matches.list;
  const float limit = in.state.profile.max_landmark_error_sq;
  for (int i : P::range(0, matches.count)) {
    const I32 feature = matches.query[i];
    const I32 old = matches.reference[i];
    if (I32(frame.features.landmarks[feature]) != I32(kNoLandmark)) continue;
    const I32 known = frame.matches.landmarks[old];
    if (known != I32(kNoLandmark) && in.is_in_use(known)) continue;
    const I32 u = frame.features.list.x[feature], v = frame.features.list.y[feature];
    const I32 old_u = frame.matches.u(old), old_v = frame.matches.v(old);
    const Vec2<P> before = in.pixel(old_u, old_v), now = in.pixel(u, v);
    const Vec3<P> point =
        triangulate<P>(in.T_before, in.T_now, before, now, in.camera, in.state.machine.local());
    if (!in.agrees(in.T_before, point, before, limit) || !in.agrees(in.T_now, point, now, limit))
      continue;
    const auto words =
        in.descriptors.subspan(I32(feature * I32(kDescriptorWords)), kDescriptorWords);
    const I32 landmark = in.graph.add_landmark(point, words);
    if (landmark < I32(0)) return;
    in.graph.add_observation(in.slot_before, landmark, old_u, old_v);
    in.graph.add_observation(in.slot_now, landmark, u, v);
    frame.features.landmarks[feature] = work::narrow<typename P::U16>(landmark);
  }
}

/// The features take the place of the last keyframe's, the empty places with them.
template <class P>
void store_whole_keyframe(FrontEndState<P>& state, const Frame<P>& frame) {
  state.keyframe.store(state.machine, frame.features, frame.features.list.capacity);
  state.time_since_keyframe = 0;
}

}  // namespace

template <class P>
void insert_keyframe(FrontEndState<P>& state, Frame<P>& frame) {
  using I32 = typename P::I32;
  work::Arena& local = state.machine.local();
  const work::Arena::Frame memory(local);
  const auto stage = state.machine.stage(stages::kTriangulation);
  constexpr Bytes kPoses(2 * 16 * 4);
  const auto insert_into = [&](const auto& graph, auto interval, const auto& remove) {
    const MatrixView<P> T_before = alloc_matrix<P>(local, "pose of the last keyframe", 4, 4);
    const MatrixView<P> T_now = alloc_matrix<P>(local, "pose of the keyframe", 4, 4);
    const I32 previous = graph.newest_keyframe();
    store_pose<P>(T_before, inverse(graph.keyframe(previous).T_world_camera));
    store_pose<P>(T_now, inverse(frame.T_world_camera));
    const KeyframeState<P> newest{frame.T_world_camera,
                                  velocity_at(state, frame.T_world_camera, graph, interval)};
    graph.age_landmarks();
    const I32 slot = graph.add_keyframe(newest, interval, remove);
    with_descriptors(frame.features.list, [&](const auto& words) {
      const Insertion<P, std::decay_t<decltype(graph)>, std::decay_t<decltype(words)>> insertion{
          state,    frame, graph,    words, CameraConstants<P>(state.rig.camera),
          T_before, T_now, previous, slot};
      inherit_landmarks(insertion);
      register_observations(insertion);
      triangulate_landmarks(insertion);
    });
  };
  with_graph_at_hand(state, kPoses + kTriangulationScratch, insert_into);
  store_whole_keyframe<P>(state, frame);
}

template void insert_keyframe(FrontEndState<work::Native>&, Frame<work::Native>&);
template void insert_keyframe(FrontEndState<work::Counting>&, Frame<work::Counting>&);

template <class P>
void match_keyframe(const FrontEndState<P>& state, Frame<P>& frame) {
  work::Machine& machine = state.machine;
  const auto stage = machine.stage(stages::kFrameMatching);
  const ObservedFeatures<P>& old = state.keyframe.features;
  KeyframeMatches<P>& matches = frame.matches;
  const DescriptorSource<P> descriptors = keyframe_descriptors(state, old.list.capacity);
  copy_keyframe_features(state, matches.first_v, matches);
  levio::match_sources<P>(machine, descriptors_of(frame), descriptors, state.profile.matcher,
                          matches.list);
}

template <class P>
typename P::F32 total_motion(const FrontEndState<P>& state, const Frame<P>& frame) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const typename P::Function function("levio_total_motion");
  const KeyframeMatches<P>& matches = frame.matches;
  const FeatureList<P>& features = frame.features.list;
  F sum = 0.0f;
  for (int i : P::range(0, matches.list.count)) {
    const I32 now = matches.list.query[i];
    const I32 old = matches.list.reference[i];
    const Vec2<P> seen = state.camera.normalised(features.x[now], features.y[now]);
    const Vec2<P> before = state.camera.normalised(matches.u(old), matches.v(old));
    const F dx = seen.x - before.x, dy = seen.y - before.y;
    sum += work::sqrt(F(dx * dx + dy * dy));
  }
  return sum;
}

template work::Native::F32 total_motion(const FrontEndState<work::Native>&,
                                        const Frame<work::Native>&);
template work::Counting::F32 total_motion(const FrontEndState<work::Counting>&,
                                          const Frame<work::Counting>&);
template void match_keyframe(const FrontEndState<work::Native>&, Frame<work::Native>&);
template void match_keyframe(const FrontEndState<work::Counting>&, Frame<work::Counting>&);

}  // namespace leviosim::vio::levio
