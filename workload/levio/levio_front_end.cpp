#include "workload/levio/levio_front_end.h"

#include "workload/levio/keyframe_insertion.h"
#include "workload/levio/keyframe_matches.h"
#include "workload/levio/vision/levio_extractor.h"
#include "workload/vio/frame_pose.h"
#include "workload/vio/keyframe_matching.h"
#include "workload/vio/keyframe_pose.h"
#include "workload/vio/keyframes.h"
#include "workload/vio/map_start.h"
#include "workload/vio/parallax.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {

template <class P>
LevioFrontEnd<P>::LevioFrontEnd(const Profile& profile, const Rig& rig, work::Machine& cluster,
                                work::Arena& keyframe_memory, const PoseGraph<P>& graph)
    : state_(profile, rig, cluster, keyframe_memory, graph),
      inertial_(state_),
      random_(profile.sampling_seed) {}

template <class P>
FrameReport LevioFrontEnd<P>::process(const FrameInput& input) {
  const work::EitherFrame memory(state_.machine);
  FrameReport report;
  if (input.wants_features) report.seen.emplace();
  Frame<P> frame;
  take_image(input, state_);
  inertial_.integrate(input);
  extract(frame);
  if (!state_.started) {
    start_map(state_, frame);
    report.keyframe = true;
  } else {
    locate(frame, report);
    report.keyframe = is_keyframe(frame);
    if (report.keyframe) levio::insert_keyframe(state_, frame);
  }
  complete(state_, frame, report);
  return report;
}

/// Features of the image in L2, as a whole or in strips.
template <class P>
void LevioFrontEnd<P>::extract(Frame<P>& frame) {
  const auto stage = state_.machine.stage(stages::kExtraction);
  const KeyframeRecord<P>& keyframe = state_.keyframe;
  const Profile& profile = state_.profile;
  const auto kind =
      profile.released ? levio::DescriptorKind::Released : levio::DescriptorKind::Exact;
  frame.features = features_of_frame<P>(state_, [&](FeatureList<P>& list) {
    if (state_.residence.image)
      levio::extract_features<P>(state_.machine, keyframe.image, profile.extractor, kind, list);
    else
      levio::extract_features_in_strips<P>(state_.machine, keyframe.image, keyframe.blurred,
                                           profile.extractor, kind, list);
  });
  forget_landmarks(frame);
}

/// From landmarks, or from the last keyframe, whose matches are needed in any case.
template <class P>
void LevioFrontEnd<P>::locate(Frame<P>& frame, FrameReport& report) {
  const std::optional<Pose<P>> pose =
      pose_from_landmarks(state_, inertial_, random_, state_.profile.epnp, frame, report);
  alloc_keyframe_matches(state_, frame);
  const work::Arena::Frame descriptors(state_.machine.local());
  levio::match_keyframe(state_, frame);
  frame.T_world_camera = pose ? *pose : pose_from_keyframe(state_, random_, frame, {}, report);
}

/// It has moved far enough, or can hardly be matched with the last one any more.
template <class P>
bool LevioFrontEnd<P>::is_keyframe(const Frame<P>& frame) {
  using F = typename P::F32;
  const auto stage = state_.machine.stage(stages::kKeyframeSelection);
  const Profile& profile = state_.profile;
  const int matches = frame.matches.list.count;
  if (matches < profile.min_frame_matches) return true;
  const F parallax = profile.released ? levio::total_motion(state_, frame)
                                      : total_parallax(state_, inertial_, frame);
  return bool(parallax > F(profile.keyframe_parallax * static_cast<float>(matches)));
}

template class LevioFrontEnd<work::Native>;
template class LevioFrontEnd<work::Counting>;

}  // namespace leviosim::vio
