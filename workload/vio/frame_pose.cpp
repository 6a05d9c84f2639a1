#include "workload/vio/frame_pose.h"

#include <algorithm>

#include "workload/geometry/essential_ransac.h"
#include "workload/geometry/pnp_ransac.h"
#include "workload/geometry/recover_pose.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {
namespace {

/// The landmarks in L1, and the features that match them.
template <class P>
struct WorldMatches {
  typename P::template Span<typename P::F32> points;
  MatchList<P> list;
  int before_filter = 0;  ///< matches with landmarks of any age
};

/// The blocks stay in L1.
template <class P>
WorldMatches<P> match_landmarks(const FrontEndState<P>& state, Frame<P>& frame) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  work::Machine& machine = state.machine;
  work::Arena& local = machine.local();
  const PoseGraph<P>& graph = state.graph;
  const int landmarks = work::value(graph.landmark_count());
  const int capacity = graph.capacity.landmarks;
  WorldMatches<P> matches;
  const auto stage = machine.stage(stages::kWorldMatching);
  const auto descriptors = local.alloc<typename P::template Span<typename P::U32>>(
      "landmark descriptors", kDescriptorWords * capacity);
  matches.points = local.alloc<typename P::template Span<F>>("landmark points", 3 * capacity);
  const auto ages =
      local.alloc<typename P::template Span<typename P::Byte>>("landmark ages", capacity);
  MatchList<P>& list = matches.list =
      alloc_matches<P>(local, frame.features.list.capacity, "world matches");
  machine.copy_in(descriptors.subspan(0, kDescriptorWords * landmarks), graph.descriptors);
  machine.copy_in(matches.points.subspan(0, 3 * landmarks), graph.points);
  machine.copy_in(ages.subspan(0, landmarks), graph.ages);
  match_two_way<P>(machine, frame.features.list.descriptors, frame.features.list.count, descriptors,
                   landmarks, state.profile.matcher, list);
  matches.before_filter = list.count;
  int kept = 0;
  for (int i : P::range(0, list.count)) {
    const I32 landmark = list.reference[i];
    const I32 age = ages[landmark];
    if (age > I32(state.profile.max_landmark_age)) continue;
    list.query[kept] = work::narrow<U16>(I32(list.query[i]));
    list.reference[kept] = work::narrow<U16>(landmark);
    frame.features.landmarks[I32(list.query[kept])] = work::narrow<U16>(landmark);
    ++kept;
  }
  list.count = kept;
  return matches;
}

template <class P>
PnpResult<P> solve_epnp(const FrontEndState<P>& state, const Frame<P>& frame,
                        const WorldMatches<P>& world) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using Floats = typename P::template Span<F>;
  work::Arena& local = state.machine.local();
  const MatchList<P>& matches = world.list;
  const auto points = local.alloc<Floats>("matched points", 3 * matches.count);
  const auto pixels = local.alloc<Floats>("matched pixels", 2 * matches.count);
  for (int i : P::range(0, matches.count)) {
    const I32 at = I32(matches.reference[i]) * I32(3);
    for (int c = 0; c < 3; ++c) points[3 * i + c] = F(world.points[I32(at + I32(c))]);
    const I32 feature = matches.query[i];
    pixels[2 * i] = state.camera.pixel(frame.features.list.x[feature]);
    pixels[2 * i + 1] = state.camera.pixel(frame.features.list.y[feature]);
  }
  PnpOptions options = state.profile.pnp;
  options.seed += state.frame_number;
  return estimate_pose_epnp<P>(state.machine, {points, pixels, matches.count, state.rig.camera},
                               options);
}

}  // namespace

template <class P>
std::optional<Pose<P>> pose_from_landmarks(const FrontEndState<P>& state,
                                           const InertialPart<P>& inertial, Frame<P>& frame,
                                           FrameReport& report) {
  const Profile& profile = state.profile;
  const work::Arena::Frame memory(state.machine.local());
  const WorldMatches<P> matches = match_landmarks(state, frame);
  report.world_matches = matches.list.count;
  if (matches.before_filter < profile.min_world_matches) return std::nullopt;
  if (!profile.use_epnp || matches.list.count < profile.min_world_matches) return std::nullopt;

  const auto stage = state.machine.stage(stages::kEpnp);
  const PnpResult<P> result = solve_epnp(state, frame, matches);
  report.inliers = result.inliers;
  const bool supported = result.ok && result.inliers >= profile.min_epnp_inliers;
  report.source = supported ? PoseSource::Epnp : PoseSource::Predicted;
  return supported ? inverse(result.T_camera_world) : inertial.predicted_pose();
}

template std::optional<Pose<work::Native>> pose_from_landmarks(const FrontEndState<work::Native>&,
                                                               const InertialPart<work::Native>&,
                                                               Frame<work::Native>&, FrameReport&);
template std::optional<Pose<work::Counting>> pose_from_landmarks(
    const FrontEndState<work::Counting>&, const InertialPart<work::Counting>&,
    Frame<work::Counting>&, FrameReport&);

namespace {

/// Both views of all matches, in L1.
template <class P>
TwoViewMatches<P> gather_views(const FrontEndState<P>& state, const Frame<P>& frame,
                               typename P::template Span<typename P::F32> a,
                               typename P::template Span<typename P::F32> b) {
  using I32 = typename P::I32;
  const KeyframeMatches<P>& matches = frame.matches;
  for (int i : P::range(0, matches.list.count)) {
    const I32 now = matches.list.query[i];
    const I32 old = matches.list.reference[i];
    const Vec2<P> in_a = state.camera.normalised(matches.u(old), matches.v(old));
    const Vec2<P> in_b =
        state.camera.normalised(frame.features.list.x[now], frame.features.list.y[now]);
    a[2 * i] = in_a.x;
    a[2 * i + 1] = in_a.y;
    b[2 * i] = in_b.x;
    b[2 * i + 1] = in_b.y;
  }
  return {a, b, matches.list.count};
}

}  // namespace

template <class P>
Pose<P> pose_from_keyframe(const FrontEndState<P>& state, const Frame<P>& frame,
                           const RotationCheck<P>& can_be_true, FrameReport& report) {
  using F = typename P::F32;
  using Floats = typename P::template Span<F>;
  const Profile& profile = state.profile;
  const KeyframeState<P> last = state.newest_keyframe();
  const int matches = frame.matches.list.count;
  report.source = PoseSource::Kept;
  if (matches < profile.min_frame_matches) return last.T_world_camera;

  work::Machine& machine = state.machine;
  work::Arena& local = machine.local();
  const work::Arena::Frame memory(local);
  const auto stage = machine.stage(stages::kEightPoint);
  const auto a = local.alloc<Floats>("matched points of the keyframe", 2 * matches);
  const auto b = local.alloc<Floats>("matched points", 2 * matches);
  const auto inliers =
      local.alloc<typename P::template Span<typename P::Byte>>("inlier mask", matches);
  const TwoViewMatches<P> views = gather_views(state, frame, a, b);
  EssentialOptions options = profile.essential;
  options.seed += state.frame_number;
  const EssentialResult<P> essential =
      estimate_essential<P>(machine, views, state.rig.camera.fx, options, inliers);
  if (!essential.ok) return last.T_world_camera;
  const TwoViewPose<P> motion = recover_pose<P>(machine, views, inliers, essential.E);
  if (!motion.ok) return last.T_world_camera;
  if (can_be_true && !can_be_true(motion.T_b_a.R)) return last.T_world_camera;

  report.source = PoseSource::EightPoint;
  report.inliers = essential.inliers;
  const F dt = std::min(state.time_since_keyframe, profile.max_translation_time);
  const F length = work::max(F(norm(last.velocity) * dt), F(profile.min_translation));
  const Pose<P> T_camera_keyframe{motion.T_b_a.R, motion.T_b_a.t * length};
  return last.T_world_camera * inverse(T_camera_keyframe);
}

template Pose<work::Native> pose_from_keyframe(const FrontEndState<work::Native>&,
                                               const Frame<work::Native>&,
                                               const RotationCheck<work::Native>&, FrameReport&);
template Pose<work::Counting> pose_from_keyframe(const FrontEndState<work::Counting>&,
                                                 const Frame<work::Counting>&,
                                                 const RotationCheck<work::Counting>&,
                                                 FrameReport&);

}  // namespace leviosim::vio
