#include "workload/next/loop/loop_part.h"

namespace leviosim::vio {
namespace {

template <class P>
bool is_storable(const Vec3<P>& x) {
  using F = typename P::F32;
  const F farthest = work::max(work::max(work::abs(x.x), work::abs(x.y)), x.z);
  return farthest < F(kFarthestPoint) && x.z > F(0.0f);
}

/// How many of the keyframes in the window have seen each landmark.
template <class P>
auto count_observations(const FrontEndState<P>& state, work::Arena& local) {
  using I32 = typename P::I32;
  using Byte = typename P::Byte;
  using Bytes = typename P::template Span<Byte>;
  using Numbers = typename P::template Span<typename P::U16>;
  const auto& graph = state.graph_in_l2;
  const Bytes counts = local.alloc<Bytes>("observations of landmarks", graph.capacity.landmarks);
  const work::Arena::Frame memory(local);
  const int n = work::value(graph.observation_count());
  const Numbers landmarks = local.alloc<Numbers>("landmarks of observations", n);
  const Bytes meant = local.alloc<Bytes>("generations of observations", n),
              alive = local.alloc<Bytes>("generations of landmarks", counts.size());
  state.machine.copy_in(landmarks, state.graph.observation_landmarks.subspan(0, n));
  state.machine.copy_in(meant, state.graph.observation_generations.subspan(0, n));
  state.machine.copy_in(alive, state.graph.generations);
  for (int i : P::range(0, counts.size())) counts[i] = work::narrow<Byte>(I32(0));
  for (int i : P::range(0, n)) {
    const I32 landmark = landmarks[i];
    if (I32(meant[i]) != I32(alive[landmark])) continue;
    counts[landmark] = work::narrow<Byte>(I32(counts[landmark]) + I32(1));
  }
  return counts;
}

}  // namespace

template <class P>
LoopPart<P>::LoopPart(const FrontEndState<P>& state, work::Arena& memory)
    : state_(state),
      closer_(state.profile.loop,
              {state.rig.camera, state.rig.width, state.rig.height,
               state.profile.extractor.subpixel_steps},
              state.machine, memory) {}

template <class P>
void LoopPart<P>::follow(const Frame<P>& frame, FrameReport& report) {
  if (report.source == PoseSource::Tracked) {
    if (is_due(frame)) {
      const LoopOutcome outcome = visit(frame);
      places_ = outcome.places;
      report.places_removed = outcome.removed;
      report.loop_closures = outcome.closures;
    } else if (closer_.has_to_improve()) {
      closer_.improve();
    }
  }
  report.places = places_;
}

template <class P>
bool LoopPart<P>::is_due(const Frame<P>& frame) const {
  const auto stage = state_.machine.stage(stages::kPlaceRecognition);
  return closer_.is_due(frame.T_world_camera);
}

/// The landmarks of the frame, as seen from its camera.
template <class P>
LoopOutcome LoopPart<P>::visit(const Frame<P>& frame) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  work::Arena& local = state_.machine.local();
  const work::Arena::Frame memory(local);
  const FeatureList<P>& features = frame.features.list;
  LoopView<P> view;
  view.features = features;
  view.T_odometry_camera = frame.T_world_camera;
  view.tracked = local.alloc<typename P::template Span<U16>>("tracked features", features.count);
  view.points = local.alloc<typename P::template Span<F>>("tracked points", 3 * features.count);
  {
    const auto stage = state_.machine.stage(stages::kPlaceRecognition);
    const Pose<P> T_camera_world = inverse(frame.T_world_camera);
    const auto observations = count_observations(state_, local);
    for (int i : P::range(0, features.count)) {
      const I32 landmark = frame.features.landmarks[i];
      if (landmark == I32(kNoLandmark)) continue;
      if (I32(observations[landmark]) < I32(state_.profile.loop.places.min_observations)) continue;
      const Vec3<P> x = T_camera_world * state_.graph_in_l2.point(landmark);
      if (!is_storable(x)) continue;
      view.tracked[view.tracked_count] = work::narrow<U16>(I32(i));
      store_vec3<P>(view.points, 3 * view.tracked_count, x);
      ++view.tracked_count;
    }
  }
  return closer_.visit(view);
}

template <class P>
void LoopPart<P>::correct(const Frame<P>& frame, float dt, FrameReport& report) {
  if (!closer_.has_closed()) return;
  static_cast<CameraPose&>(report) = plain(closer_.corrected(frame.T_world_camera, dt));
}

template class LoopPart<work::Native>;
template class LoopPart<work::Counting>;

}  // namespace leviosim::vio
