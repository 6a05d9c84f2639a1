#include "workload/vio/levio/landmark_pose.h"

#include "workload/vio/levio/geometry/epnp_ransac.h"
#include "workload/vio/levio/vision/matcher.h"
#include "workload/vio/stages.h"

namespace leviosim::vio::levio {
namespace {

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
                                           ShiftRegister<P>& random, Frame<P>& frame,
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
  const EpnpRansacOptions options{.inlier_px = profile.pnp.inlier_px};
  const EpnpResult<P> result = estimate_pose_epnp<P>(
      state.machine, matches, CameraConstants<P>(state.rig.camera), random, options);
  report.inliers = result.inliers;
  const bool supported = result.ok && result.inliers >= profile.min_epnp_inliers;
  report.source = supported ? PoseSource::Epnp : PoseSource::Predicted;
  return supported ? inverse(result.T_camera_world) : inertial.predicted_pose();
}

template std::optional<Pose<work::Native>> pose_from_landmarks(const FrontEndState<work::Native>&,
                                                               const InertialPart<work::Native>&,
                                                               ShiftRegister<work::Native>&,
                                                               Frame<work::Native>&, FrameReport&);
template std::optional<Pose<work::Counting>> pose_from_landmarks(
    const FrontEndState<work::Counting>&, const InertialPart<work::Counting>&,
    ShiftRegister<work::Counting>&, Frame<work::Counting>&, FrameReport&);

}  // namespace leviosim::vio::levio
