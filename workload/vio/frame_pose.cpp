#include "workload/vio/frame_pose.h"

#include <algorithm>

#include "workload/levio/geometry/eight_point.h"
#include "workload/levio/geometry/epnp_ransac.h"
#include "workload/levio/geometry/essential_ransac.h"
#include "workload/levio/geometry/pose_matrix.h"
#include "workload/levio/geometry/pose_recovery.h"
#include "workload/levio/vision/levio_matcher.h"
#include "workload/vio/keyframe_pose.h"
#include "workload/vio/seen_features.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {
namespace {

using levio::CameraConstants;
using levio::LandmarkMatches;

/// Whether descriptors, points and ages of all landmarks have room beside what their matches and
/// their pose take. Else descriptors pass in tiles, and points and ages of matches come from L2.
template <class P>
bool landmarks_fit(const FrontEndState<P>& state) {
  constexpr std::int64_t kLandmark = 4 * kDescriptorWords + 4 * 3 + 1;
  constexpr std::int64_t kMatch = 3 * 2 + 4 * 5;
  const int matches = state.keyframe.features.list.capacity;
  const int cores = state.machine.cores();
  return Bytes(kLandmark * state.graph.capacity.landmarks + kMatch * matches) +
             levio::epnp_memory(matches, cores) <=
         state.machine.local().free();
}

/// The features that match landmarks.
template <class P>
MatchList<P> match_landmarks(const FrontEndState<P>& state, const Frame<P>& frame, bool resident) {
  using Words = typename P::template Span<typename P::U32>;
  work::Machine& machine = state.machine;
  const PoseGraph<P>& graph = state.graph;
  Words descriptors = graph.descriptors;
  if (resident)
    descriptors = machine.local().alloc<Words>("landmark descriptors",
                                               kDescriptorWords * graph.capacity.landmarks);
  MatchList<P> list =
      alloc_matches<P>(machine, list_capacity(state, frame.features.list.count), "world matches");
  if (resident) machine.copy_in(descriptors, graph.descriptors);
  const DescriptorSource<P> reference{descriptors, work::value(graph.landmark_count()), !resident,
                                      "tile of landmark descriptors"};
  levio::match_sources<P>(machine, descriptors_of(frame), reference, state.profile.matcher, list);
  return list;
}

template <class P>
struct MatchedSpans {
  using F = typename P::F32;

  MatchedSpans(work::Machine& machine, int matches)
      : points(work::alloc_either<P, F>(machine, "matched points", 3 * matches)),
        pixels(work::alloc_either<P, F>(machine, "matched pixels", 2 * matches)) {}

  typename P::template EitherSpan<F> points, pixels;
};

/// The matches with landmarks that are not too old, side by side; marks their features.
/// @param points, ages  of all landmarks
template <class P, class Points, class Ages>
LandmarkMatches<P> gather(const FrontEndState<P>& state, const Frame<P>& frame,
                          const MatchList<P>& list, const Points& points, const Ages& ages,
                          const MatchedSpans<P>& matched) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  int kept = 0;
  for (int i : P::range(0, list.count)) {
    const I32 landmark = list.reference[i];
    const I32 age = ages[landmark];
    if (age > I32(state.profile.max_landmark_age)) continue;
    const I32 feature = list.query[i];
    const I32 at = landmark * I32(3);
    for (int c = 0; c < 3; ++c) matched.points[3 * kept + c] = F(points[I32(at + I32(c))]);
    matched.pixels[2 * kept] = state.camera.pixel(frame.features.list.x[feature]);
    matched.pixels[2 * kept + 1] = state.camera.pixel(frame.features.list.y[feature]);
    frame.features.landmarks[feature] = work::narrow<U16>(landmark);
    ++kept;
  }
  return {matched.points, matched.pixels, kept};
}

/// gather() from copies in local memory, or from L2.
template <class P>
LandmarkMatches<P> gather(const FrontEndState<P>& state, const Frame<P>& frame,
                          const MatchList<P>& list, bool resident) {
  work::Machine& machine = state.machine;
  work::Arena& local = machine.local();
  if (!resident)
    return gather<P>(state, frame, list, state.graph_in_l2.points, state.graph_in_l2.ages,
                     MatchedSpans<P>(machine, list.count));
  const int capacity = state.graph.capacity.landmarks;
  const auto points =
      local.alloc<typename P::template Span<typename P::F32>>("landmark points", 3 * capacity);
  const auto ages =
      local.alloc<typename P::template Span<typename P::Byte>>("landmark ages", capacity);
  const MatchedSpans<P> matched(machine, list.count);
  machine.copy_in(points, state.graph.points);
  machine.copy_in(ages, state.graph.ages);
  return gather<P>(state, frame, list, points, ages, matched);
}

}  // namespace

template <class P>
std::optional<Pose<P>> pose_from_landmarks(const FrontEndState<P>& state,
                                           const InertialPart<P>& inertial,
                                           levio::ShiftRegister<P>& random,
                                           const levio::EpnpRansacOptions& epnp, Frame<P>& frame,
                                           FrameReport& report) {
  const Profile& profile = state.profile;
  const work::EitherFrame memory(state.machine);
  LandmarkMatches<P> matches;
  {
    const auto stage = state.machine.stage(stages::kWorldMatching);
    const bool resident = landmarks_fit(state);
    const MatchList<P> list = match_landmarks(state, frame, resident);
    report.world_matches = list.count;
    if (list.count < profile.min_world_matches) return std::nullopt;
    matches = gather(state, frame, list, resident);
  }
  report.world_matches = matches.n;
  if (!profile.use_epnp || matches.n < profile.min_world_matches) return std::nullopt;

  const auto stage = state.machine.stage(stages::kEpnp);
  const levio::EpnpResult<P> result = levio::estimate_pose_epnp<P>(
      state.machine, matches, CameraConstants<P>(state.rig.camera), random, epnp);
  report.inliers = result.inliers;
  note_reprojections_on_host(state, frame, result.T_camera_world, report);
  const bool supported = result.ok && result.inliers >= profile.min_epnp_inliers;
  report.source = supported ? PoseSource::Epnp : PoseSource::Predicted;
  return supported ? inverse(result.T_camera_world) : inertial.predicted_pose();
}

#define LEVIOSIM_INSTANTIATE(P)                                                  \
  template std::optional<Pose<P>> pose_from_landmarks(                           \
      const FrontEndState<P>&, const InertialPart<P>&, levio::ShiftRegister<P>&, \
      const levio::EpnpRansacOptions&, Frame<P>&, FrameReport&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

namespace {

/// Both views of all matches, in pixels and in normalised coordinates. Either may be missing.
template <class P>
struct Views {
  using F = typename P::F32;
  using Floats = typename P::template EitherSpan<F>;

  void alloc_pixels(work::Machine& machine, int matches) {
    pixels_a = work::alloc_either<P, F>(machine, "keypoints of the keyframe", 2 * matches);
    pixels_b = work::alloc_either<P, F>(machine, "keypoints", 2 * matches);
  }
  void alloc_normalised(work::Machine& machine, int matches) {
    a = work::alloc_either<P, F>(machine, "normalised keypoints of the keyframe", 2 * matches);
    b = work::alloc_either<P, F>(machine, "normalised keypoints", 2 * matches);
  }
  levio::PixelMatches<P> pixels(int n) const { return {pixels_a, pixels_b, n}; }
  levio::TwoViewMatches<P> normalised(int n) const { return {a, b, n}; }

  Floats pixels_a, pixels_b, a, b;
};

template <class P>
void put(typename P::template EitherSpan<typename P::F32> to, int i, typename P::F32 x,
         typename P::F32 y) {
  to[2 * i] = x;
  to[2 * i + 1] = y;
}

/// Local memory of the estimate with pixels and normalised coordinates at once.
Bytes memory_of_both_views(int matches, int cores) {
  constexpr std::int64_t kMatch = 4 * 2 * 4 + 1;
  return Bytes(kMatch * matches + 4 * 9) +
         std::max(levio::essential_memory(matches, cores), levio::recovery_memory(matches, cores));
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
    if (views.pixels_a.size() > 0) {
      put<P>(views.pixels_a, i, old_u, old_v);
      put<P>(views.pixels_b, i, u, v);
    }
    if (views.a.size() == 0) continue;
    const Vec2<P> a = camera.normalised(old_u, old_v);
    const Vec2<P> b = camera.normalised(u, v);
    put<P>(views.a, i, a.x, a.y);
    put<P>(views.b, i, b.x, b.y);
  }
}

}  // namespace

template <class P>
Bytes keyframe_pose_memory(const FrontEndState<P>& state) {
  return memory_of_both_views(state.keyframe.features.list.capacity, state.machine.cores());
}

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
  const work::EitherFrame memory(machine);
  const auto stage = machine.stage(stages::kEightPoint);
  const CameraConstants<P> camera(state.rig.camera);
  // Without room for both, pixels take the place of normalised coordinates when those are done
  // with.
  const bool both = memory_of_both_views(n, machine.cores()) <= local.free();
  Views<P> views;
  if (both) {
    views.alloc_pixels(machine, n);
    views.alloc_normalised(machine, n);
  }
  const auto inliers = local.alloc<typename P::template Span<typename P::Byte>>("inlier mask", n);
  const MatrixView<P> essential = alloc_matrix<P>(local, "best essential matrix", 3, 3);
  levio::EssentialResult<P> found;
  {
    const work::EitherFrame normalised(machine);
    if (!both) views.alloc_normalised(machine, n);
    gather(state, frame, camera, views);
    const F pixel = F(profile.essential_inlier_px) / camera.fx();
    found = levio::estimate_essential<P>(machine, views.normalised(n), pixel * pixel, random,
                                         profile.essential, essential, inliers);
  }
  if (!found.ok) return last.T_world_camera;
  if (!both) {
    views = {};
    views.alloc_pixels(machine, n);
    gather(state, frame, camera, views);
  }
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
  template Bytes keyframe_pose_memory(const FrontEndState<P>&);                          \
  template Pose<P> pose_from_keyframe(const FrontEndState<P>&, levio::ShiftRegister<P>&, \
                                      const Frame<P>&, const RotationCheck<P>&, FrameReport&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
