#include "workload/vio/next/initial_path.h"

#include <algorithm>

#include "workload/vio/frame.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {

template <class P>
InitialPath<P>::InitialPath(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                            work::Arena& arena, int frames)
    : state_(state), inertial_(inertial), frames_(frames) {
  if (frames_ == 0) return;
  intervals_ = arena.alloc<Floats>("motion of the first frames", kFloats * frames_);
  keyframe_ids_ = {arena.alloc<Ids>("keyframes of the first frames", frames_).data(), frames_};
}

template <class P>
void InitialPath<P>::remember() {
  if (frames_ == 0) return;
  work::Machine& machine = state_.machine;
  const work::Arena::Frame memory(machine.local());
  const auto stage = machine.stage(stages::kGuided);
  const auto record = machine.local().template alloc<Floats>("IMU interval", kFloats);
  machine.copy_in(record, state_.keyframe.interval.subspan(0, kFloats));
  const int at = count_++ % frames_;
  machine.copy_out(intervals_.subspan(at * kFloats, kFloats), record);
  const auto& graph = state_.graph_in_l2;
  // uncounted: a place a frame
  keyframe_ids_[at] = I32(graph.keyframe_ids[graph.newest_keyframe()]);
}

template <class P>
std::vector<EarlierPose> InitialPath<P>::poses() {
  std::vector<EarlierPose> poses;
  if (count_ == 0) return poses;
  work::Machine& machine = state_.machine;
  const work::Arena::Frame memory(machine.local());
  const auto stage = machine.stage(stages::kGuided);
  const auto record = machine.local().template alloc<Floats>("IMU interval", kFloats);
  const auto& graph = state_.graph_in_l2;
  for (int n = std::max(0, count_ - frames_); n < count_; ++n) {
    const int at = n % frames_;
    const I32 id = keyframe_ids_[at];  // uncounted: a place a frame
    for (int k : P::range(0, work::value(graph.keyframe_count()))) {
      const I32 slot = graph.keyframe_slot(k);
      if (I32(graph.keyframe_ids[slot]) != id) continue;
      machine.copy_in(record, intervals_.subspan(at * kFloats, kFloats));
      const ImuDelta<P> delta = Preintegration<P>(record).corrected(graph.bias());
      const Pose<P> T = inertial_.moved_on(graph.keyframe(slot), delta);
      poses.push_back({plain(T), count_ - n});
    }
  }
  clear();
  return poses;
}

template class InitialPath<work::Native>;
template class InitialPath<work::Counting>;

}  // namespace leviosim::vio
