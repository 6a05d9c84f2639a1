#include "workload/vio/levio/levio_front_end.h"

#include "workload/vio/keyframe_insertion.h"
#include "workload/vio/keyframe_matching.h"
#include "workload/vio/landmark_pose.h"
#include "workload/vio/map_start.h"
#include "workload/vio/parallax.h"
#include "workload/vio/stages.h"
#include "workload/vio/two_view_pose.h"

namespace leviosim::vio {

template <class P>
LevioFrontEnd<P>::LevioFrontEnd(const Profile& profile, const Rig& rig, work::Machine& cluster,
                                work::Arena& keyframe_memory, const PoseGraph<P>& graph)
    : state_(profile, rig, cluster, keyframe_memory, graph), inertial_(state_) {}

template <class P>
FrameReport LevioFrontEnd<P>::process(const FrameInput& input) {
  const work::Arena::Frame memory(state_.machine.local());
  FrameReport report;
  Frame<P> frame;
  take_image(input, state_);
  inertial_.integrate(input);
  extract_frame(state_, frame);
  if (!state_.started) {
    start_map(state_, frame);
    report.keyframe = true;
  } else {
    locate(frame, report);
    report.keyframe = is_keyframe(frame);
    if (report.keyframe) insert_keyframe(state_, frame);
  }
  complete(state_, frame, report);
  return report;
}

/// From landmarks, or from the last keyframe, whose matches are needed in any case.
template <class P>
void LevioFrontEnd<P>::locate(Frame<P>& frame, FrameReport& report) {
  const std::optional<Pose<P>> pose = pose_from_landmarks(state_, inertial_, frame, report);
  alloc_keyframe_matches(state_, frame);
  const work::Arena::Frame descriptors(state_.machine.local());
  match_keyframe(state_, frame);
  frame.T_world_camera = pose ? *pose : pose_from_keyframe<P>(state_, frame, {}, report);
}

/// It has moved far enough, or can hardly be matched with the last one any more.
template <class P>
bool LevioFrontEnd<P>::is_keyframe(const Frame<P>& frame) {
  using F = typename P::F32;
  const auto stage = state_.machine.stage(stages::kKeyframeSelection);
  const Profile& profile = state_.profile;
  const int matches = frame.matches.list.count;
  if (matches < profile.min_frame_matches) return true;
  const F parallax = total_parallax(state_, inertial_, frame);
  return bool(parallax > F(profile.keyframe_parallax * static_cast<float>(matches)));
}

template class LevioFrontEnd<work::Native>;
template class LevioFrontEnd<work::Counting>;

}  // namespace leviosim::vio
