#include "workload/vio/levio/keyframe_matching.h"

#include "workload/vio/levio/vision/matcher.h"
#include "workload/vio/stages.h"

namespace leviosim::vio::levio {

template <class P>
void match_keyframe(const FrontEndState<P>& state, Frame<P>& frame) {
  using Words = typename P::template Span<typename P::U32>;
  work::Machine& machine = state.machine;
  const auto stage = machine.stage(stages::kFrameMatching);
  const ObservedFeatures<P>& old = state.keyframe.features;
  KeyframeMatches<P>& matches = frame.matches;
  const int capacity = old.list.capacity;
  const auto descriptors =
      machine.local().alloc<Words>("descriptors of the keyframe", kDescriptorWords * capacity);
  machine.copy_in(descriptors, old.list.descriptors);
  machine.copy_in(matches.pixels.subspan(0, capacity), old.list.x);
  machine.copy_in(matches.pixels.subspan(matches.first_v, capacity), old.list.y);
  machine.copy_in(matches.landmarks, old.landmarks);
  levio::match_two_way<P>(machine, frame.features.list.descriptors, frame.features.list.count,
                          descriptors, old.list.count, state.profile.matcher, matches.list);
}

template <class P>
typename P::F32 total_motion(const FrontEndState<P>& state, const Frame<P>& frame) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const typename P::Function function("levio_total_motion");
  const KeyframeMatches<P>& matches = frame.matches;
  const FeatureList<P>& features = frame.features.list;
  F sum = 0.0f;
  for (int i : P::range(0, matches.list.count)) {
    const I32 now = matches.list.query[i];
    const I32 old = matches.list.reference[i];
    const Vec2<P> seen = state.camera.normalised(features.x[now], features.y[now]);
    const Vec2<P> before = state.camera.normalised(matches.u(old), matches.v(old));
    const F dx = seen.x - before.x, dy = seen.y - before.y;
    sum += work::sqrt(F(dx * dx + dy * dy));
  }
  return sum;
}

template work::Native::F32 total_motion(const FrontEndState<work::Native>&,
                                        const Frame<work::Native>&);
template work::Counting::F32 total_motion(const FrontEndState<work::Counting>&,
                                          const Frame<work::Counting>&);
template void match_keyframe(const FrontEndState<work::Native>&, Frame<work::Native>&);
template void match_keyframe(const FrontEndState<work::Counting>&, Frame<work::Counting>&);

}  // namespace leviosim::vio::levio
