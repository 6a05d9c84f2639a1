#include "workload/vio/frame.h"

#include <cstring>

#include "workload/vio/seen_features.h"
#include "workload/vio/stages.h"
#include "workload/vision/strip_extractor.h"

namespace leviosim::vio {

template <class P>
void take_image(const FrameInput& input, FrontEndState<P>& state) {
  // uncounted: the camera's own transfer
  std::memcpy(static_cast<void*>(state.keyframe.image.pixels.data()), input.pixels,
              static_cast<std::size_t>(input.width * input.height));
  ++state.frame_number;
  state.time_since_keyframe += input.dt;
}

template <class P>
void extract_frame(FrontEndState<P>& state, Frame<P>& frame) {
  const auto stage = state.machine.stage(stages::kExtraction);
  const ExtractorOptions& options = state.profile.extractor;
  const KeyframeRecord<P>& keyframe = state.keyframe;
  frame.features = features_of_frame<P>(state, [&](FeatureList<P>& list) {
    if (!state.residence.image)
      extract_features_in_strips<P>(state.machine, keyframe.image, keyframe.blurred, options, list);
    else
      extract_features<P>(state.machine, keyframe.image, options, list);
  });
  forget_landmarks(frame);
}

template <class P>
void forget_landmarks(const Frame<P>& frame) {
  using I32 = typename P::I32;
  for (int i : P::range(0, frame.features.list.count))
    frame.features.landmarks[i] = work::narrow<typename P::U16>(I32(kNoLandmark));
}

template <class P>
CameraPose plain(const Pose<P>& T) {
  CameraPose pose;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) pose.R_world_camera[3 * r + c] = work::value(T.R.m[r][c]);
  pose.p_world_camera = {work::value(T.t.x), work::value(T.t.y), work::value(T.t.z)};
  return pose;
}

template <class P>
void complete(const FrontEndState<P>& state, const Frame<P>& frame, FrameReport& report) {
  report.features = frame.features.list.count;
  report.frame_matches = frame.matches.list.count;
  report.landmarks = work::value(state.graph.landmark_count());
  report.state = static_cast<int>(state_of(report.source));
  static_cast<CameraPose&>(report) = plain(frame.T_world_camera);
  note_features_on_host(state, frame, report);
}

#define LEVIOSIM_INSTANTIATE(P)                                   \
  template void take_image(const FrameInput&, FrontEndState<P>&); \
  template void extract_frame(FrontEndState<P>&, Frame<P>&);      \
  template void forget_landmarks(const Frame<P>&);                \
  template CameraPose plain(const Pose<P>&);                      \
  template void complete(const FrontEndState<P>&, const Frame<P>&, FrameReport&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
