#include "workload/vio/seen_features.h"

namespace leviosim::vio {
namespace {

template <class P>
std::array<float, 3> point_on_host(const FrontEndState<P>& state, int landmark) {
  const auto* const point = state.graph.points.data() + 3 * landmark;
  return {work::value(point[0]), work::value(point[1]), work::value(point[2])};
}

}  // namespace

template <class P>
void note_inliers_on_host(const Frame<P>& frame, const MatchList<P>& matches,
                          typename P::template Span<typename P::Byte> inliers,
                          FrameReport& report) {
  if (!report.seen) return;
  report.seen->assign(static_cast<std::size_t>(frame.features.list.count), {});
  for (int i = 0; i < matches.count; ++i)
    (*report.seen)[matches.query.data()[i]].state =
        static_cast<int>(inliers.data()[i]) != 0 ? FeatureState::Agrees : FeatureState::Rejected;
}

template <class P>
void note_reprojections_on_host(const FrontEndState<P>& state, const Frame<P>& frame,
                                const Pose<P>& T_camera_world, FrameReport& report) {
  if (!report.seen) return;
  report.seen->assign(static_cast<std::size_t>(frame.features.list.count), {});
  const CameraPose T = plain(T_camera_world);
  const PinholeCamera& camera = state.rig.camera;
  const auto steps = static_cast<float>(state.profile.extractor.subpixel_steps);
  for (std::size_t i = 0; i < report.seen->size(); ++i) {
    const int landmark = frame.features.landmarks.data()[i];
    if (landmark == kNoLandmark) continue;
    const std::array<float, 3> point = point_on_host(state, landmark);
    std::array<float, 3> x = T.p_world_camera;
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) x[r] += T.R_world_camera[3 * r + c] * point[c];
    const float u = camera.fx * x[0] / x[2] + camera.cx, v = camera.fy * x[1] / x[2] + camera.cy;
    const float du = u - static_cast<float>(frame.features.list.x.data()[i]) / steps;
    const float dv = v - static_cast<float>(frame.features.list.y.data()[i]) / steps;
    const float limit = state.profile.epnp.inlier_px;
    (*report.seen)[i].state = x[2] > 0 && du * du + dv * dv < limit * limit
                                  ? FeatureState::Agrees
                                  : FeatureState::Rejected;
  }
}

template <class P>
void note_features_on_host(const FrontEndState<P>& state, const Frame<P>& frame,
                           FrameReport& report) {
  if (!report.seen) return;
  std::vector<SeenFeature>& seen = *report.seen;
  const FeatureList<P>& features = frame.features.list;
  const auto steps = static_cast<float>(state.profile.extractor.subpixel_steps);
  seen.resize(static_cast<std::size_t>(features.count));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    seen[i].x = seen[i].x_before = static_cast<float>(features.x.data()[i]) / steps;
    seen[i].y = seen[i].y_before = static_cast<float>(features.y.data()[i]) / steps;
  }
  const KeyframeMatches<P>& matches = frame.matches;
  for (int i = 0; i < matches.list.count; ++i) {
    SeenFeature& feature = seen[matches.list.query.data()[i]];
    const int old = matches.list.reference.data()[i];
    feature.x_before = static_cast<float>(matches.pixels.data()[old]) / steps;
    feature.y_before = static_cast<float>(matches.pixels.data()[old + matches.first_v]) / steps;
    if (feature.state != FeatureState::Detected) continue;
    const bool shows = frame.features.landmarks.data()[matches.list.query.data()[i]] != kNoLandmark;
    // A keyframe's feature shows the landmark of its match, or a new one.
    if (!report.keyframe || !shows)
      feature.state = FeatureState::Matched;
    else
      feature.state =
          matches.landmarks.data()[old] == kNoLandmark ? FeatureState::New : FeatureState::Agrees;
  }
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (const int landmark = frame.features.landmarks.data()[i]; landmark != kNoLandmark)
      seen[i].p_world = point_on_host(state, landmark);
}

#define LEVIOSIM_INSTANTIATE(P)                                                         \
  template void note_inliers_on_host(const Frame<P>&, const MatchList<P>&,              \
                                     typename P::Span<typename P::Byte>, FrameReport&); \
  template void note_reprojections_on_host(const FrontEndState<P>&, const Frame<P>&,    \
                                           const Pose<P>&, FrameReport&);               \
  template void note_features_on_host(const FrontEndState<P>&, const Frame<P>&, FrameReport&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
