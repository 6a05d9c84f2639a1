#include "workload/vio/next/guided_tracking.h"

#include "workload/geometry/pose_refinement.h"
#include "workload/vio/landmark_pose.h"
#include "workload/vio/stages.h"
#include "workload/vision/guided_matcher.h"

namespace leviosim::vio {
namespace {

/// How far a predicted pose is trusted.
struct LandmarkSearch {
  float radius_px;
  float rotation, position;  ///< standard deviation of each axis, rad and m
};

/// Landmarks in L1, and the features that were found around where a pose puts them.
template <class P>
struct FoundLandmarks {
  typename P::template Span<typename P::F32> points;
  MatchList<P> matches;
};

/// Of the landmarks only their points stay in L1.
template <class P>
void match_around(const FrontEndState<P>& state, const FeatureList<P>& features,
                  const Pose<P>& T_camera_world, float radius_px, FoundLandmarks<P>& found) {
  const Profile& profile = state.profile;
  const Rig& rig = state.rig;
  work::Machine& machine = state.machine;
  work::Arena& local = machine.local();
  const int landmarks = found.points.size() / 3;
  const auto stage = machine.stage(stages::kGuided);
  const work::Arena::Frame descriptions(local);
  const auto descriptors = local.alloc<typename P::template Span<typename P::U32>>(
      "landmark descriptors", kDescriptorWords * landmarks);
  const auto ages =
      local.alloc<typename P::template Span<typename P::Byte>>("landmark ages", landmarks);
  machine.copy_in(descriptors, state.graph.descriptors);
  machine.copy_in(found.points, state.graph.points);
  machine.copy_in(ages, state.graph.ages);
  const GuidedInput<P> input{
      found.points,   descriptors, ages,      landmarks,  profile.max_landmark_age,
      T_camera_world, rig.camera,  rig.width, rig.height, profile.extractor.subpixel_steps};
  GuidedOptions options = profile.guided;
  options.radius_px = radius_px;
  options.min_depth = profile.optimiser.visual.min_depth;
  match_guided<P>(machine, input, features, options, found.matches);
}

/// What the refinement of a pose takes, in L1.
template <class P>
PnpInput<P> gather_matches(const FrontEndState<P>& state, const FeatureList<P>& features,
                           const FoundLandmarks<P>& found,
                           typename P::template Span<typename P::F32> points,
                           typename P::template Span<typename P::F32> pixels) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const MatchList<P>& matches = found.matches;
  state.machine.fork("gather", [&](work::Core& core) {
    const auto [begin, end] = core.share(matches.count);
    for (int i : P::range(begin, end)) {
      const I32 at = I32(matches.reference[i]) * I32(3);
      for (int c = 0; c < 3; ++c) points[3 * i + c] = F(found.points[I32(at + I32(c))]);
      const I32 feature = matches.query[i];
      pixels[2 * i] = state.camera.pixel(features.x[feature]);
      pixels[2 * i + 1] = state.camera.pixel(features.y[feature]);
    }
  });
  return {points, pixels, matches.count, state.rig.camera};
}

/// Features know the landmarks of the matches that agree with the pose, and no others.
template <class P>
void keep_inliers(const Frame<P>& frame, const MatchList<P>& matches,
                  typename P::template Span<typename P::Byte> inliers) {
  using I32 = typename P::I32;
  forget_landmarks(frame);
  for (int i : P::range(0, matches.count)) {
    if (I32(inliers[i]) == I32(0)) continue;
    frame.features.landmarks[I32(matches.query[i])] =
        work::narrow<typename P::U16>(I32(matches.reference[i]));
  }
}

/// The pose refined to the landmarks found around where T_predicted (T_world_camera) puts them, if
/// enough agree with it.
template <class P>
std::optional<Pose<P>> search_landmarks(const FrontEndState<P>& state, const Frame<P>& frame,
                                        const Pose<P>& T_predicted, const LandmarkSearch& search,
                                        FrameReport& report) {
  using Floats = typename P::template Span<typename P::F32>;
  const Profile& profile = state.profile;
  work::Arena& local = state.machine.local();
  const work::Arena::Frame memory(local);
  const FeatureList<P>& features = frame.features.list;
  const int landmarks = work::value(state.graph.landmark_count());
  FoundLandmarks<P> found;
  found.points = local.alloc<Floats>("landmark points", 3 * landmarks);
  found.matches = alloc_matches<P>(local, features.capacity, "world matches");
  const Pose<P> T_camera_world = inverse(T_predicted);
  match_around(state, features, T_camera_world, search.radius_px, found);
  const int matches = found.matches.count;
  report.world_matches = matches;
  if (matches < profile.min_world_matches) return std::nullopt;

  const auto stage = state.machine.stage(stages::kRefinement);
  const auto points = local.alloc<Floats>("matched points", 3 * matches);
  const auto pixels = local.alloc<Floats>("matched pixels", 2 * matches);
  const auto inliers =
      local.alloc<typename P::template Span<typename P::Byte>>("inlier mask", matches);
  const PnpInput<P> input = gather_matches(state, features, found, points, pixels);
  RefinementOptions options = profile.refinement;
  options.rotation = search.rotation;
  options.position = search.position;
  options.min_depth = profile.optimiser.visual.min_depth;
  const RefinedPose<P> refined =
      refine_pose<P>(state.machine, input, T_camera_world, options, inliers);
  report.inliers = refined.inliers;
  const float agreeing = options.min_share * static_cast<float>(matches);
  if (!refined.ok || refined.inliers < profile.min_epnp_inliers ||
      static_cast<float>(refined.inliers) < agreeing)
    return std::nullopt;
  report.source = PoseSource::Tracked;
  keep_inliers(frame, found.matches, inliers);
  return inverse(refined.T_camera_world);
}

}  // namespace

template <class P>
std::optional<Pose<P>> track_landmarks(const FrontEndState<P>& state,
                                       const InertialPart<P>& inertial, const Pose<P>& T_predicted,
                                       TrackedFrame<P>& frame, FrameReport& report) {
  if (work::value(state.graph.landmark_count()) == 0) return std::nullopt;
  const RefinementOptions& refinement = state.profile.refinement;
  const RecoveryOptions& recovery = state.profile.recovery;
  const LandmarkSearch near{state.profile.guided.radius_px, refinement.rotation,
                            refinement.position};
  const LandmarkSearch wide{recovery.wide_radius_px, recovery.rotation, recovery.position};
  if (const auto pose = search_landmarks<P>(state, frame, T_predicted, near, report)) return pose;
  if (recovery.wide_radius_px > 0)
    if (const auto pose = search_landmarks<P>(state, frame, T_predicted, wide, report)) return pose;
  // Lost: look for all landmarks in all of the image, then again around where EPnP puts them, which
  // is no prediction.
  forget_landmarks<P>(frame);
  const std::optional<Pose<P>> recovered = pose_from_landmarks<P>(state, inertial, frame, report);
  if (!recovered || report.source != PoseSource::Epnp) return recovered;
  const LandmarkSearch around{near.radius_px, recovery.recovered_rotation,
                              recovery.recovered_position};
  const auto pose = search_landmarks<P>(state, frame, *recovered, around, report);
  return pose ? pose : recovered;
}

template std::optional<Pose<work::Native>> track_landmarks(const FrontEndState<work::Native>&,
                                                           const InertialPart<work::Native>&,
                                                           const Pose<work::Native>&,
                                                           TrackedFrame<work::Native>&,
                                                           FrameReport&);
template std::optional<Pose<work::Counting>> track_landmarks(const FrontEndState<work::Counting>&,
                                                             const InertialPart<work::Counting>&,
                                                             const Pose<work::Counting>&,
                                                             TrackedFrame<work::Counting>&,
                                                             FrameReport&);

}  // namespace leviosim::vio
