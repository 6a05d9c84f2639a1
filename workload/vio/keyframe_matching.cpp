#include "workload/vio/keyframe_matching.h"

#include "workload/vio/stages.h"

namespace leviosim::vio {

template <class P>
void alloc_keyframe_matches(const FrontEndState<P>& state, Frame<P>& frame) {
  using Table = typename KeyframeMatches<P>::Table;
  work::Arena& local = state.machine.local();
  const int capacity = state.keyframe.features.list.capacity;
  frame.matches.list = alloc_matches<P>(local, frame.features.list.capacity, "frame matches");
  frame.matches.pixels = local.alloc<Table>("keypoints of the keyframe", 2 * capacity);
  frame.matches.first_v = capacity;
  frame.matches.landmarks = local.alloc<Table>("landmarks of the keyframe", capacity);
}

template <class P>
void match_keyframe(const FrontEndState<P>& state, Frame<P>& frame) {
  using Words = typename P::template Span<typename P::U32>;
  work::Machine& machine = state.machine;
  const auto stage = machine.stage(stages::kFrameMatching);
  const ObservedFeatures<P>& old = state.keyframe.features;
  KeyframeMatches<P>& matches = frame.matches;
  const int n = old.list.count;
  const auto descriptors = machine.local().alloc<Words>("descriptors of the keyframe",
                                                        kDescriptorWords * old.list.capacity);
  machine.copy_in(descriptors.subspan(0, kDescriptorWords * n), old.list.descriptors);
  machine.copy_in(matches.pixels.subspan(0, n), old.list.x);
  machine.copy_in(matches.pixels.subspan(matches.first_v, n), old.list.y);
  machine.copy_in(matches.landmarks.subspan(0, n), old.landmarks);
  match_two_way<P>(machine, frame.features.list.descriptors, frame.features.list.count, descriptors,
                   n, state.profile.matcher, matches.list);
}

template void alloc_keyframe_matches(const FrontEndState<work::Native>&, Frame<work::Native>&);
template void alloc_keyframe_matches(const FrontEndState<work::Counting>&, Frame<work::Counting>&);
template void match_keyframe(const FrontEndState<work::Native>&, Frame<work::Native>&);
template void match_keyframe(const FrontEndState<work::Counting>&, Frame<work::Counting>&);

}  // namespace leviosim::vio
