#include "workload/next/guided_tracking.h"

#include <algorithm>

#include "workload/next/feature_alignment.h"
#include "workload/next/pose_refinement.h"
#include "workload/vio/frame_pose.h"
#include "workload/vio/seen_features.h"
#include "workload/vio/stages.h"
#include "workload/vision/guided_matcher.h"
#include "workload/vision/patch_alignment.h"

namespace leviosim::vio {
namespace {

/// How far a predicted pose is trusted.
struct LandmarkSearch {
  float radius_px;
  float rotation, position;  ///< standard deviation of each axis, rad and m
};

/// The features that were found around where a pose puts landmarks, whose points stay in L1 if they
/// have room there.
template <class P>
struct FoundLandmarks {
  typename P::template Span<typename P::F32> points;
  bool points_in_l2;
  MatchList<P> matches;
};

/// Whether all that guided matching needs of landmarks has room in L1.
template <class P>
bool landmarks_fit(const FrontEndState<P>& state, int features, int landmarks) {
  constexpr std::int64_t kLandmark = 4 * kDescriptorWords + 4 * 3 + 1;
  const Bytes matches(6LL * state.keyframe.features.list.capacity);
  return Bytes(kLandmark * landmarks) + matches +
             guided_memory(state.profile.guided, state.rig.width, state.rig.height, features,
                           landmarks) <=
         state.machine.local().free();
}

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
  typename P::template Span<typename P::U32> descriptors = state.graph.descriptors;
  typename P::template Span<typename P::Byte> ages = state.graph.ages;
  if (!found.points_in_l2) {
    descriptors = local.alloc<typename P::template Span<typename P::U32>>(
        "landmark descriptors", kDescriptorWords * landmarks);
    ages = local.alloc<typename P::template Span<typename P::Byte>>("landmark ages", landmarks);
    machine.copy_in(descriptors, state.graph.descriptors);
    machine.copy_in(found.points, state.graph.points);
    machine.copy_in(ages, state.graph.ages);
  }
  const GuidedInput<P> input{
      found.points,      descriptors, ages,      landmarks,  profile.max_landmark_age,
      T_camera_world,    rig.camera,  rig.width, rig.height, profile.extractor.subpixel_steps,
      found.points_in_l2};
  GuidedOptions options = profile.guided;
  options.radius_px = radius_px;
  options.min_depth = profile.optimiser.visual.min_depth;
  match_guided<P>(machine, input, features, options, found.matches);
}

/// What the refinement of a pose takes, in L1.
template <class P>
levio::LandmarkMatches<P> gather_matches(const FrontEndState<P>& state,
                                         const FeatureList<P>& features,
                                         const FoundLandmarks<P>& found,
                                         typename P::template EitherSpan<typename P::F32> points,
                                         typename P::template EitherSpan<typename P::F32> pixels) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const MatchList<P>& matches = found.matches;
  const auto gather_from = [&](const auto& all_points) {
    state.machine.fork("gather", [&](work::Core& core) {
      const auto [begin, end] = core.share(matches.count);
      for (int i : P::range(begin, end)) {
        const I32 at = I32(matches.reference[i]) * I32(3);
        for (int c = 0; c < 3; ++c) points[3 * i + c] = F(all_points[I32(at + I32(c))]);
        const I32 feature = matches.query[i];
        pixels[2 * i] = state.camera.pixel(features.x[feature]);
        pixels[2 * i + 1] = state.camera.pixel(features.y[feature]);
      }
    });
  };
  if (found.points_in_l2)
    gather_from(state.graph_in_l2.points);
  else
    gather_from(found.points);
  return {points, pixels, matches.count};
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
  const work::EitherFrame memory(state.machine);
  const FeatureList<P>& features = frame.features.list;
  const int landmarks = work::value(state.graph.landmark_count());
  FoundLandmarks<P> found;
  found.points_in_l2 = !landmarks_fit(state, features.count, landmarks);
  found.points = found.points_in_l2 ? state.graph.points.subspan(0, 3 * landmarks)
                                    : local.alloc<Floats>("landmark points", 3 * landmarks);
  found.matches = alloc_matches<P>(
      state.machine, list_capacity(state, std::min(features.count, landmarks)), "world matches");
  const Pose<P> T_camera_world = inverse(T_predicted);
  match_around(state, features, T_camera_world, search.radius_px, found);
  const int matches = found.matches.count;
  report.world_matches = matches;
  if (matches < profile.min_world_matches) return std::nullopt;

  const auto stage = state.machine.stage(stages::kRefinement);
  using F = typename P::F32;
  const auto points = work::alloc_either<P, F>(state.machine, "matched points", 3 * matches);
  const auto pixels = work::alloc_either<P, F>(state.machine, "matched pixels", 2 * matches);
  const auto inliers =
      local.alloc<typename P::template Span<typename P::Byte>>("inlier mask", matches);
  const levio::LandmarkMatches<P> input = gather_matches(state, features, found, points, pixels);
  RefinementOptions options = profile.refinement;
  options.rotation = search.rotation;
  options.position = search.position;
  options.min_depth = profile.optimiser.visual.min_depth;
  const RefinedPose<P> refined =
      refine_pose<P>(state.machine, input, state.rig.camera, T_camera_world, options, inliers);
  report.inliers = refined.inliers;
  const float agreeing = options.min_share * static_cast<float>(matches);
  if (!refined.ok || refined.inliers < profile.min_epnp_inliers ||
      static_cast<float>(refined.inliers) < agreeing)
    return std::nullopt;
  report.source = PoseSource::Tracked;
  keep_inliers(frame, found.matches, inliers);
  note_inliers_on_host(frame, found.matches, inliers, report);
  return inverse(refined.T_camera_world);
}

}  // namespace

template <class P>
std::optional<Pose<P>> track_landmarks(const FrontEndState<P>& state,
                                       const InertialPart<P>& inertial,
                                       levio::ShiftRegister<P>& random, const Pose<P>& T_predicted,
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
  levio::EpnpRansacOptions epnp = state.profile.epnp;
  epnp.iterations = recovery.hypotheses;
  const std::optional<Pose<P>> recovered =
      pose_from_landmarks<P>(state, inertial, random, epnp, frame, report);
  if (!recovered || report.source != PoseSource::Epnp) return recovered;
  const LandmarkSearch around{near.radius_px, recovery.recovered_rotation,
                              recovery.recovered_position};
  const auto pose = search_landmarks<P>(state, frame, *recovered, around, report);
  return pose ? pose : recovered;
}

#define LEVIOSIM_INSTANTIATE(P)                                                                    \
  template std::optional<Pose<P>> track_landmarks(const FrontEndState<P>&, const InertialPart<P>&, \
                                                  levio::ShiftRegister<P>&, const Pose<P>&,        \
                                                  TrackedFrame<P>&, FrameReport&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

namespace {

template <class P>
using Numbers = typename P::template EitherSpan<typename P::U16>;
template <class P>
using Flags = typename P::template Span<typename P::Byte>;

/// The image for patch alignment: a copy in local memory, or itself, in L2.
template <class P>
ConstImageView<P> image_at_hand(work::Machine& machine, std::string_view name,
                                const ImageView<P>& from, bool resident) {
  if (!resident) return from;
  const ImageView<P> to{machine.local().alloc<Flags<P>>(name, from.width * from.height), from.width,
                        from.height};
  machine.copy_in(to.pixels, from.pixels);
  return to;
}

/// Local memory of align_features() besides the images.
template <class P>
Bytes aligning_memory(const FrontEndState<P>& state, bool windows) {
  constexpr std::int64_t kFeature = 2 * 1 + 2 * 2 + 3 * 2;
  const PatchAlignmentOptions& options = state.profile.patches;
  return Bytes(kFeature * state.keyframe.features.list.capacity) +
         patch_scratch(options, std::max(options.max_shift, options.reach), windows, windows) *
             state.machine.cores();
}

/// Places in the present image where features of the keyframe should be.
template <class P>
struct Predictions {
  Predictions(work::Machine& machine, int capacity)
      : x(work::alloc_either<P, typename P::U16>(machine, "predicted features", 2 * capacity)),
        y(x.subspan(capacity, capacity)),
        pairs(alloc_matches<P>(machine, capacity, "predicted matches")) {}

  Numbers<P> x, y;
  MatchList<P> pairs;  ///< place → feature of the keyframe
};

/// Marks the features of the keyframe that have a match.
template <class P>
void mark_matched(const MatchList<P>& matches, int features, Flags<P> matched) {
  using I32 = typename P::I32;
  using Byte = typename P::Byte;
  for (int i : P::range(0, features)) matched[i] = work::narrow<Byte>(I32(0));
  for (int i : P::range(0, matches.count))
    matched[I32(matches.reference[i])] = work::narrow<Byte>(I32(1));
}

/// Where the keyframe's landmarks that have no match should be.
template <class P>
void predict_landmarks(const FrontEndState<P>& state, const Frame<P>& frame,
                       const Pose<P>& T_camera_world, Flags<P> matched, Predictions<P>& to) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  const typename P::Function function("predict_landmarks");
  const PinholeCamera& c = state.rig.camera;
  const F steps = static_cast<float>(state.profile.extractor.subpixel_steps);
  const F border = static_cast<float>(state.profile.extractor.border);
  const F right = static_cast<float>(state.rig.width) - border;
  const F bottom = static_cast<float>(state.rig.height) - border;
  const int room =
      std::min(to.pairs.capacity, frame.features.list.capacity - frame.features.list.count);
  int n = 0;
  for (int i : P::range(0, state.keyframe.features.list.count)) {
    if (n == room) break;
    const I32 landmark = frame.matches.landmarks[i];
    if (landmark == I32(kNoLandmark) || I32(matched[i]) != I32(0)) continue;
    if (I32(state.graph_in_l2.ages[landmark]) > I32(state.profile.max_landmark_age)) continue;
    const Vec3<P> x = T_camera_world * state.graph_in_l2.point(landmark);
    if (!(x.z > F(state.profile.optimiser.visual.min_depth))) continue;
    const F inverse = F(1.0f) / x.z;
    const F u = F(c.fx) * (x.x * inverse) + F(c.cx), v = F(c.fy) * (x.y * inverse) + F(c.cy);
    if (!(u > border) || !(v > border) || !(u < right) || !(v < bottom)) continue;
    to.x[n] = work::narrow<U16>(work::to_i32(F(u * steps)));
    to.y[n] = work::narrow<U16>(work::to_i32(F(v * steps)));
    to.pairs.query[n] = work::narrow<U16>(I32(n));
    to.pairs.reference[n] = work::narrow<U16>(I32(i));
    ++n;
  }
  to.pairs.count = n;
}

/// Takes the matches off the list whose patches disagree: corners that slid along an edge, or were
/// taken for others. What is left keeps its order.
template <class P>
void drop_disagreeing(Flags<P> verdicts, MatchList<P>& matches) {
  using I32 = typename P::I32;
  const typename P::Function function("drop_disagreeing");
  keep_matches(matches, [&](int i) {
    return bool(I32(verdicts[i]) != I32(static_cast<int>(PatchVerdict::Disagrees)));
  });
}

/// The descriptor of the keyframe's feature `old` becomes that of feature `at`.
template <class P>
void copy_descriptor(const FrontEndState<P>& state, int old, const FeatureList<P>& features,
                     int at) {
  using U32 = typename P::U32;
  const auto from =
      state.keyframe.features.list.descriptors.subspan(kDescriptorWords * old, kDescriptorWords);
  const auto to = features.descriptors.subspan(kDescriptorWords * at, kDescriptorWords);
  if (!features.descriptors_in_l2) return state.machine.copy_in(to, from);
  const typename P::template L2Span<U32> from_l2(from.data(), kDescriptorWords),
      to_l2(to.data(), kDescriptorWords);
  for (int w : P::range(0, kDescriptorWords)) to_l2[w] = U32(from_l2[w]);
}

/// Those that were found become features and matches.
template <class P>
void adopt_found(const FrontEndState<P>& state, const Predictions<P>& predictions, Flags<P> found,
                 Frame<P>& frame) {
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  const typename P::Function function("adopt_found");
  FeatureList<P>& features = frame.features.list;
  MatchList<P>& matches = frame.matches.list;
  for (int i : P::range(0, predictions.pairs.count)) {
    if (I32(found[i]) != I32(static_cast<int>(PatchVerdict::Agrees)) ||
        matches.count == matches.capacity)
      continue;
    const int at = features.count++;
    const I32 old = predictions.pairs.reference[i];
    features.x[at] = work::narrow<U16>(I32(predictions.x[i]));
    features.y[at] = work::narrow<U16>(I32(predictions.y[i]));
    frame.features.landmarks[at] = work::narrow<U16>(I32(kNoLandmark));
    copy_descriptor(state, work::value(old), features, at);
    const int match = matches.count++;
    matches.query[match] = work::narrow<U16>(I32(at));
    matches.reference[match] = work::narrow<U16>(old);
    matches.distance[match] = work::narrow<U16>(I32(0));
  }
}

}  // namespace

template <class P>
void align_features(const FrontEndState<P>& state, Frame<P>& frame,
                    const std::optional<Pose<P>>& T_predicted) {
  const PatchAlignmentOptions& options = state.profile.patches;
  if (state.keyframe.seen.width == 0) return;
  work::Machine& machine = state.machine;
  work::Arena& local = machine.local();
  const auto stage = machine.stage(stages::kPatches);
  const work::EitherFrame memory(machine);
  const int steps = state.profile.extractor.subpixel_steps;
  const KeyframeMatches<P>& matches = frame.matches;
  const int n = matches.first_v;
  const Bytes pixels(static_cast<std::int64_t>(state.rig.width) * state.rig.height);
  const bool both = pixels * 2 + aligning_memory(state, false) <= local.free();
  const bool one = both || pixels + aligning_memory(state, true) <= local.free();
  const PatchView<P> before{
      image_at_hand<P>(machine, "image of the keyframe", state.keyframe.seen, both),
      matches.pixels.subspan(0, n), matches.pixels.subspan(n, n), !both};
  const ConstImageView<P> image = image_at_hand<P>(machine, "image", state.keyframe.image, one);
  const auto aligned = local.alloc<Flags<P>>("aligned", n);
  align_patches<P>(machine, before, {image, frame.features.list.x, frame.features.list.y, !one},
                   steps, options.max_shift, options, matches.list, aligned);
  if (options.required) drop_disagreeing<P>(aligned, frame.matches.list);
  if (!T_predicted || !(options.reach > 0)) return;
  const auto matched = local.alloc<Flags<P>>("matched", n);
  mark_matched<P>(matches.list, state.keyframe.features.list.count, matched);
  Predictions<P> predictions(machine,
                             state.residence.whole_lists ? n : most_found_by_patches(state));
  predict_landmarks<P>(state, frame, inverse(*T_predicted), matched, predictions);
  align_patches<P>(machine, before, {image, predictions.x, predictions.y, !one}, steps,
                   options.reach, options, predictions.pairs, aligned);
  adopt_found<P>(state, predictions, aligned, frame);
}

template void align_features(const FrontEndState<work::Native>&, Frame<work::Native>&,
                             const std::optional<Pose<work::Native>>&);
template void align_features(const FrontEndState<work::Counting>&, Frame<work::Counting>&,
                             const std::optional<Pose<work::Counting>>&);

}  // namespace leviosim::vio
