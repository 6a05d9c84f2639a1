#include "workload/vio/frame_pose.h"

#include <algorithm>

#include "workload/levio/geometry/eight_point.h"
#include "workload/levio/geometry/epnp_ransac.h"
#include "workload/levio/geometry/essential_ransac.h"
#include "workload/levio/geometry/pose_matrix.h"
#include "workload/levio/geometry/pose_recovery.h"
#include "workload/levio/vision/levio_matcher.h"
#include "workload/vio/keyframe_pose.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {
namespace {

using levio::CameraConstants;
using levio::LandmarkMatches;

/// The landmarks in L1, and the features that match them. The blocks stay in L1.
template <class P>
MatchList<P> match_landmarks(const FrontEndState<P>& state, const Frame<P>& frame) {
  work::Machine& machine = state.machine;
  const PoseGraph<P>& graph = state.graph;
  const auto descriptors = machine.local().alloc<typename P::template Span<typename P::U32>>(
      "landmark descriptors", kDescriptorWords * graph.capacity.landmarks);
  MatchList<P> list =
      alloc_matches<P>(machine.local(), frame.features.list.capacity, "world matches");
  machine.copy_in(descriptors, graph.descriptors);
  levio::match_two_way<P>(machine, frame.features.list.descriptors, frame.features.list.count,
                          descriptors, work::value(graph.landmark_count()), state.profile.matcher,
                          list);
  return list;
}

/// The matches with landmarks that are not too old, side by side; marks their features.
template <class P>
LandmarkMatches<P> gather(const FrontEndState<P>& state, const Frame<P>& frame,
                          const MatchList<P>& list) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  using Floats = typename P::template Span<F>;
  work::Machine& machine = state.machine;
  work::Arena& local = machine.local();
  const int capacity = state.graph.capacity.landmarks;
  const auto points = local.alloc<Floats>("landmark points", 3 * capacity);
  const auto ages =
      local.alloc<typename P::template Span<typename P::Byte>>("landmark ages", capacity);
  const auto matched_points = local.alloc<Floats>("matched points", 3 * list.count);
  const auto matched_pixels = local.alloc<Floats>("matched pixels", 2 * list.count);
  machine.copy_in(points, state.graph.points);
  machine.copy_in(ages, state.graph.ages);
  int kept = 0;
  for (int i : P::range(0, list.count)) {
    const I32 landmark = list.reference[i];
    const I32 age = ages[landmark];
    if (age > I32(state.profile.max_landmark_age)) continue;
    const I32 feature = list.query[i];
    const I32 at = landmark * I32(3);
    for (int c = 0; c < 3; ++c) matched_points[3 * kept + c] = F(points[I32(at + I32(c))]);
    matched_pixels[2 * kept] = state.camera.pixel(frame.features.list.x[feature]);
    matched_pixels[2 * kept + 1] = state.camera.pixel(frame.features.list.y[feature]);
    frame.features.landmarks[feature] = work::narrow<U16>(landmark);
    ++kept;
  }
  return {matched_points, matched_pixels, kept};
}

}  // namespace

template <class P>
std::optional<Pose<P>> pose_from_landmarks(const FrontEndState<P>& state,
                                           const InertialPart<P>& inertial,
                                           levio::ShiftRegister<P>& random, Frame<P>& frame,
                                           FrameReport& report) {
  const Profile& profile = state.profile;
  const work::Arena::Frame memory(state.machine.local());
  LandmarkMatches<P> matches;
  {
    const auto stage = state.machine.stage(stages::kWorldMatching);
    const MatchList<P> list = match_landmarks(state, frame);
    report.world_matches = list.count;
    if (list.count < profile.min_world_matches) return std::nullopt;
    matches = gather(state, frame, list);
  }
  report.world_matches = matches.n;
  if (!profile.use_epnp || matches.n < profile.min_world_matches) return std::nullopt;

  const auto stage = state.machine.stage(stages::kEpnp);
  const levio::EpnpResult<P> result = levio::estimate_pose_epnp<P>(
      state.machine, matches, CameraConstants<P>(state.rig.camera), random, profile.epnp);
  report.inliers = result.inliers;
  const bool supported = result.ok && result.inliers >= profile.min_epnp_inliers;
  report.source = supported ? PoseSource::Epnp : PoseSource::Predicted;
  return supported ? inverse(result.T_camera_world) : inertial.predicted_pose();
}

#define LEVIOSIM_INSTANTIATE(P)                                                             \
  template std::optional<Pose<P>> pose_from_landmarks(                                      \
      const FrontEndState<P>&, const InertialPart<P>&, levio::ShiftRegister<P>&, Frame<P>&, \
      FrameReport&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

namespace {

/// Both views of all matches, in pixels and in normalised coordinates.
template <class P>
struct Views {
  using Floats = typename P::template Span<typename P::F32>;

  Views(work::Arena& local, int matches)
      : pixels_a(local.alloc<Floats>("keypoints of the keyframe", 2 * matches)),
        pixels_b(local.alloc<Floats>("keypoints", 2 * matches)),
        a(local.alloc<Floats>("normalised keypoints of the keyframe", 2 * matches)),
        b(local.alloc<Floats>("normalised keypoints", 2 * matches)) {}

  levio::PixelMatches<P> pixels(int n) const { return {pixels_a, pixels_b, n}; }
  levio::TwoViewMatches<P> normalised(int n) const { return {a, b, n}; }

  Floats pixels_a, pixels_b, a, b;
};

template <class P>
void put(typename P::template Span<typename P::F32> to, int i, typename P::F32 x,
         typename P::F32 y) {
  to[2 * i] = x;
  to[2 * i + 1] = y;
}

/// The master's work: four divisions per match.
template <class P>
void gather(const FrontEndState<P>& state, const Frame<P>& frame, const CameraConstants<P>& camera,
            const Views<P>& views) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const KeyframeMatches<P>& matches = frame.matches;
  for (int i : P::range(0, matches.list.count)) {
    const I32 now = matches.list.query[i];
    const I32 old = matches.list.reference[i];
    const F old_u = state.camera.pixel(matches.u(old)), old_v = state.camera.pixel(matches.v(old));
    const F u = state.camera.pixel(frame.features.list.x[now]);
    const F v = state.camera.pixel(frame.features.list.y[now]);
    put<P>(views.pixels_a, i, old_u, old_v);
    put<P>(views.pixels_b, i, u, v);
    const Vec2<P> a = camera.normalised(old_u, old_v);
    const Vec2<P> b = camera.normalised(u, v);
    put<P>(views.a, i, a.x, a.y);
    put<P>(views.b, i, b.x, b.y);
  }
}

}  // namespace

template <class P>
Pose<P> pose_from_keyframe(const FrontEndState<P>& state, levio::ShiftRegister<P>& random,
                           const Frame<P>& frame, const RotationCheck<P>& can_be_true,
                           FrameReport& report) {
  using F = typename P::F32;
  const Profile& profile = state.profile;
  const KeyframeState<P> last = state.newest_keyframe();
  const int n = frame.matches.list.count;
  report.source = PoseSource::Kept;
  if (n < profile.min_frame_matches) return last.T_world_camera;

  work::Machine& machine = state.machine;
  work::Arena& local = machine.local();
  const work::Arena::Frame memory(local);
  const auto stage = machine.stage(stages::kEightPoint);
  const CameraConstants<P> camera(state.rig.camera);
  const Views<P> views(local, n);
  const auto inliers = local.alloc<typename P::template Span<typename P::Byte>>("inlier mask", n);
  const MatrixView<P> essential = alloc_matrix<P>(local, "best essential matrix", 3, 3);
  gather(state, frame, camera, views);
  const F pixel = F(profile.essential_inlier_px) / camera.fx();
  const levio::EssentialResult<P> found = levio::estimate_essential<P>(
      machine, views.normalised(n), pixel * pixel, random, profile.essential, essential, inliers);
  if (!found.ok) return last.T_world_camera;
  const levio::RecoveredPose<P> motion =
      levio::recover_pose<P>(machine, essential, views.pixels(n), camera);
  if (!motion.ok) return last.T_world_camera;
  if (can_be_true && !can_be_true(motion.T_b_a.R)) return last.T_world_camera;

  report.source = PoseSource::EightPoint;
  report.inliers = found.inliers;
  const F dt = std::min(state.time_since_keyframe, profile.max_translation_time);
  const F length = work::max(F(norm(last.velocity) * dt), F(profile.min_translation));
  const Pose<P> T_camera_keyframe{motion.T_b_a.R, motion.T_b_a.t * length};
  return last.T_world_camera * inverse(T_camera_keyframe);
}

#define LEVIOSIM_INSTANTIATE(P)                                                          \
  template Pose<P> pose_from_keyframe(const FrontEndState<P>&, levio::ShiftRegister<P>&, \
                                      const Frame<P>&, const RotationCheck<P>&, FrameReport&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
