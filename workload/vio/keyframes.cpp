#include "workload/vio/keyframes.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "workload/math/solve.h"
#include "workload/vio/graph_at_hand.h"
#include "workload/vio/keyframe_matching.h"
#include "workload/vio/keyframe_pose.h"
#include "workload/vio/map_start.h"
#include "workload/vio/parallax.h"
#include "workload/vio/stages.h"
#include "workload/vio/triangulation.h"

namespace leviosim::vio {
namespace {

/// Not so old that it is skipped, as those are that have retired.
template <class P, class Graph>
bool is_in_use(const FrontEndState<P>& state, const Graph& graph, typename P::I32 landmark) {
  using I32 = typename P::I32;
  return bool(I32(graph.ages[landmark]) <= I32(state.profile.max_landmark_age));
}

/// Landmarks that were recognised, directly or through the features of the last keyframe.
template <class P, class Graph, class Words>
void register_observations(const FrontEndState<P>& state, const Frame<P>& frame, const Graph& graph,
                           const Words& descriptors, typename P::I32 slot, bool aligned) {
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
                              descriptors.subspan(kDescriptorWords * i, kDescriptorWords));
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
template <class P, class Graph, class Words>
void add_landmarks(const FrontEndState<P>& state, const Frame<P>& frame, const Graph& graph,
                   const Words& descriptors, typename P::I32 previous_slot, typename P::I32 slot,
                   float any_depth) {
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
    const auto words = descriptors.subspan(I32(feature * I32(kDescriptorWords)), kDescriptorWords);
    const I32 landmark = graph.add_landmark(*point, words);
    if (landmark < I32(0)) return;
    graph.add_observation(previous_slot, landmark, old_u, old_v);
    graph.add_observation(slot, landmark, u, v);
    frame.features.landmarks[feature] = work::narrow<U16>(landmark);
  }
}

}  // namespace

template <class P, class Graph>
Vec3<P> velocity_at(const FrontEndState<P>& state, const Pose<P>& T_world_camera,
                    const Graph& graph, typename P::template Span<typename P::F32> interval) {
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
  const work::Arena::Frame memory(state.machine.local());
  const auto stage = state.machine.stage(stages::kTriangulation);
  const auto insert_into = [&](const auto& graph, auto interval, const auto& remove) {
    const KeyframeState<P> newest{frame.T_world_camera,
                                  velocity_at(state, frame.T_world_camera, graph, interval)};
    const I32 previous = graph.newest_keyframe();
    graph.age_landmarks();
    const I32 slot = graph.add_keyframe(newest, interval, remove);
    with_descriptors(frame.features.list, [&](const auto& words) {
      register_observations(state, frame, graph, words, slot, any_depth == 0);
      add_landmarks(state, frame, graph, words, previous, slot, any_depth);
    });
  };
  with_graph_at_hand(state, kTriangulationScratch, insert_into);
  store_keyframe(state, frame);
}

template <class P>
void store_keyframe(FrontEndState<P>& state, const Frame<P>& frame) {
  state.keyframe.store(state.machine, frame.features, frame.features.list.count);
  // The camera writes the next image to where the one of the keyframe before was.
  if (state.keyframe.seen.width > 0) std::swap(state.keyframe.image, state.keyframe.seen);
  state.time_since_keyframe = 0;
}

#define LEVIOSIM_INSTANTIATE(P)                                                              \
  template void insert_keyframe(FrontEndState<P>&, Frame<P>&, float);                        \
  template Vec3<P> velocity_at(const FrontEndState<P>&, const Pose<P>&, const PoseGraph<P>&, \
                               P::Span<P::F32>);                                             \
  template Vec3<P> velocity_at(const FrontEndState<P>&, const Pose<P>&,                      \
                               const PoseGraph<P, LongBlocksInL2>&, P::Span<P::F32>);        \
  template void store_keyframe(FrontEndState<P>&, const Frame<P>&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

template <class P>
void alloc_keyframe_matches(const FrontEndState<P>& state, Frame<P>& frame) {
  using Table = typename KeyframeMatches<P>::Table;
  using Numbers = typename P::template Span<typename P::U16>;
  work::Machine& machine = state.machine;
  const ObservedFeatures<P>& old = state.keyframe.features;
  const int capacity = list_capacity(state, old.list.count);
  KeyframeMatches<P>& matches = frame.matches;
  // Features of the keyframe that are found by their patches become matches, too.
  matches.list = alloc_matches<P>(
      machine, list_capacity(state, frame.features.list.count + most_found_by_patches(state)),
      "frame matches");
  matches.in_l2 = !machine.has_room(Bytes(3LL * sizeof(typename P::U16) * capacity));
  if (matches.in_l2) {
    // The columns of a list lie one behind the other.
    matches.first_v = old.list.capacity;
    matches.pixels = Table(old.list.x.data(), 2 * matches.first_v).in_l2();
    matches.landmarks = old.landmarks;
    return;
  }
  matches.first_v = capacity;
  matches.pixels = machine.local().alloc<Numbers>("keypoints of the keyframe", 2 * capacity);
  matches.landmarks = machine.local().alloc<Numbers>("landmarks of the keyframe", capacity);
}

template <class P>
DescriptorSource<P> keyframe_descriptors(const FrontEndState<P>& state, int number) {
  using Words = typename P::template Span<typename P::U32>;
  work::Machine& machine = state.machine;
  const FeatureList<P>& old = state.keyframe.features.list;
  const Bytes words(4LL * kDescriptorWords * old.capacity);
  const Bytes matching(6LL * old.capacity + 4LL * machine.cores());
  if (words + std::max(matching, keyframe_pose_memory(state)) > machine.local().free())
    return {old.descriptors, old.count, true, "tile of the keyframe's descriptors"};
  const auto descriptors =
      machine.local().alloc<Words>("descriptors of the keyframe", kDescriptorWords * old.capacity);
  machine.copy_in(descriptors.subspan(0, kDescriptorWords * number), old.descriptors);
  return {descriptors, old.count};
}

template <class P>
void copy_keyframe_features(const FrontEndState<P>& state, int number,
                            const KeyframeMatches<P>& to) {
  if (to.in_l2) return;
  work::Machine& machine = state.machine;
  const ObservedFeatures<P>& old = state.keyframe.features;
  machine.copy_in(to.pixels.subspan(0, number), old.list.x);
  machine.copy_in(to.pixels.subspan(to.first_v, number), old.list.y);
  machine.copy_in(to.landmarks.subspan(0, number), old.landmarks);
}

template <class P>
void match_keyframe(const FrontEndState<P>& state, Frame<P>& frame) {
  work::Machine& machine = state.machine;
  const auto stage = machine.stage(stages::kFrameMatching);
  const ObservedFeatures<P>& old = state.keyframe.features;
  KeyframeMatches<P>& matches = frame.matches;
  const int n = old.list.count;
  const DescriptorSource<P> descriptors = keyframe_descriptors(state, n);
  copy_keyframe_features(state, n, matches);
  match_sources<P>(machine, descriptors_of(frame), descriptors, state.profile.matcher,
                   matches.list);
}

template DescriptorSource<work::Native> keyframe_descriptors(const FrontEndState<work::Native>&,
                                                             int);
template DescriptorSource<work::Counting> keyframe_descriptors(const FrontEndState<work::Counting>&,
                                                               int);
template void copy_keyframe_features(const FrontEndState<work::Native>&, int,
                                     const KeyframeMatches<work::Native>&);
template void copy_keyframe_features(const FrontEndState<work::Counting>&, int,
                                     const KeyframeMatches<work::Counting>&);
template void alloc_keyframe_matches(const FrontEndState<work::Native>&, Frame<work::Native>&);
template void alloc_keyframe_matches(const FrontEndState<work::Counting>&, Frame<work::Counting>&);
template void match_keyframe(const FrontEndState<work::Native>&, Frame<work::Native>&);
template void match_keyframe(const FrontEndState<work::Counting>&, Frame<work::Counting>&);

namespace {

/// What undoes the rotation since the keyframe.
template <class P>
Mat3<P> rotation_to_undo(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                         const Frame<P>& frame) {
  if (state.profile.use_imu) return transpose(inertial.motion_since_keyframe().R);
  const KeyframeState<P> last = state.newest_keyframe();
  return transpose(frame.T_world_camera.R) * last.T_world_camera.R;
}

}  // namespace

template <class P>
Parallax<P> parallax_of(const FrontEndState<P>& state, const Frame<P>& frame, int i,
                        const Mat3<P>& R_camera_keyframe) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const KeyframeMatches<P>& matches = frame.matches;
  const FeatureList<P>& features = frame.features.list;
  const I32 now = matches.list.query[i];
  const I32 old = matches.list.reference[i];
  const Vec2<P> seen = state.camera.normalised(features.x[now], features.y[now]);
  const Vec2<P> before = state.camera.normalised(matches.u(old), matches.v(old));
  const Vec3<P> turned = R_camera_keyframe * Vec3<P>{before.x, before.y, 1.0f};
  const F scale = F(1.0f) / turned.z;
  return {seen, {seen.x - turned.x * scale, seen.y - turned.y * scale}};
}

template <class P>
typename P::F32 total_parallax(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                               const Frame<P>& frame) {
  using F = typename P::F32;
  const typename P::Function function("total_parallax");
  const Mat3<P> R_camera_keyframe = rotation_to_undo(state, inertial, frame);
  F sum = 0.0f;
  for (int i : P::range(0, frame.matches.list.count)) {
    const Vec2<P> moved = parallax_of(state, frame, i, R_camera_keyframe).moved;
    sum += work::sqrt(F(moved.x * moved.x + moved.y * moved.y));
  }
  return sum;
}

/// A camera that moves by t sees a point at distance d and (x, y) move by (x t.z - t.x) / d and
/// (y t.z - t.y) / d.
template <class P>
std::optional<Vec3<P>> motion_over_distance(const FrontEndState<P>& state, const Frame<P>& frame,
                                            const Mat3<P>& R_camera_keyframe, float most) {
  using F = typename P::F32;
  F x = 0.0f, y = 0.0f, radius_sq = 0.0f;
  Vec3<P> b{0.0f, 0.0f, 0.0f};
  int near = 0;
  for (int i : P::range(0, frame.matches.list.count)) {
    const auto [seen, moved] = parallax_of(state, frame, i, R_camera_keyframe);
    if (moved.x * moved.x + moved.y * moved.y > F(most * most)) continue;
    ++near;
    x += seen.x;
    y += seen.y;
    radius_sq += seen.x * seen.x + seen.y * seen.y;
    b = b + Vec3<P>{-moved.x, -moved.y, moved.x * seen.x + moved.y * seen.y};
  }
  const auto count = static_cast<float>(near);
  const Mat3<P> H{{{count, 0.0f, -x}, {0.0f, count, -y}, {-x, -y, radius_sq}}};
  Mat3<P> inverse;
  if (near < state.profile.min_frame_matches || 2 * near < frame.matches.list.count ||
      !invert_spd3<P>(H, inverse))
    return std::nullopt;
  return inverse * b;
}

#define LEVIOSIM_INSTANTIATE(P)                                                                    \
  template Parallax<P> parallax_of(const FrontEndState<P>&, const Frame<P>&, int, const Mat3<P>&); \
  template P::F32 total_parallax(const FrontEndState<P>&, const InertialPart<P>&,                  \
                                 const Frame<P>&);                                                 \
  template std::optional<Vec3<P>> motion_over_distance(const FrontEndState<P>&, const Frame<P>&,   \
                                                       const Mat3<P>&, float);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

template <class P>
void start_map(FrontEndState<P>& state, Frame<P>& frame) {
  using Floats = typename P::template Span<typename P::F32>;
  work::Arena& local = state.machine.local();
  const work::Arena::Frame memory(local);
  const auto stage = state.machine.stage(stages::kTriangulation);
  const auto record = local.alloc<Floats>("IMU interval", Preintegration<P>::kFloats);
  state.machine.copy_in(record, state.keyframe.interval);
  frame.T_world_camera = Pose<P>::identity();
  const Vec3<P> force = load_vec3<P>(record, 0);
  const bool upright = state.profile.optimiser.joint;
  if (upright) frame.T_world_camera.R = upright_rotation<P>(force);
  const Vec3<P> gravity = upright ? Vec3<P>{0.0f, 0.0f, -kGravity}
                                  : gravity_from_force<P>(force, frame.T_world_camera.R);
  begin_map<P>(state, frame, record, ImuBias<P>::zero(), gravity);
}

template <class P>
void begin_map(FrontEndState<P>& state, const Frame<P>& frame,
               typename P::template Span<typename P::F32> record, const ImuBias<P>& bias,
               const Vec3<P>& gravity) {
  const auto& graph = state.graph_in_l2;
  if (state.started)
    graph.restart(bias, gravity);
  else
    graph.clear(bias, gravity);
  graph.set_bias_prior(BiasPrior<P>::unknown(state.profile.biases));
  Preintegration<P>(record).reset(bias);
  graph.add_keyframe({frame.T_world_camera, {0.0f, 0.0f, 0.0f}}, record);
  state.machine.copy_out(state.keyframe.interval, record);
  store_keyframe<P>(state, frame);
  state.started = true;
}

template void start_map(FrontEndState<work::Native>&, Frame<work::Native>&);
template void start_map(FrontEndState<work::Counting>&, Frame<work::Counting>&);
template void begin_map(FrontEndState<work::Native>&, const Frame<work::Native>&,
                        work::Native::Span<float>, const ImuBias<work::Native>&,
                        const Vec3<work::Native>&);
template void begin_map(FrontEndState<work::Counting>&, const Frame<work::Counting>&,
                        work::Counting::Span<work::F32>, const ImuBias<work::Counting>&,
                        const Vec3<work::Counting>&);

}  // namespace leviosim::vio
