#include "workload/vio/levio/keyframe_matching.h"

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
  match_two_way<P>(machine, frame.features.list.descriptors, frame.features.list.count, descriptors,
                   old.list.count, state.profile.matcher, matches.list);
}

template void match_keyframe(const FrontEndState<work::Native>&, Frame<work::Native>&);
template void match_keyframe(const FrontEndState<work::Counting>&, Frame<work::Counting>&);

}  // namespace leviosim::vio::levio
