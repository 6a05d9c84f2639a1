#include "workload/next/initial_path.h"

#include <algorithm>

#include "workload/vio/keyframe_pose.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {

template <class P>
InitialPath<P>::InitialPath(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                            work::Arena& arena, int frames)
    : state_(state), inertial_(inertial), frames_(frames) {
  if (frames_ == 0) return;
  taken_s_.resize(static_cast<std::size_t>(frames_));
  motions_ = arena.alloc<Floats>("motion of the first frames", kFloats * frames_);
  since_ = {arena.alloc<Ids>("keyframes before the first frames", frames_).data(), frames_};
  became_ = {arena.alloc<Ids>("keyframes of the first frames", frames_).data(), frames_};
}

template <class P>
typename InitialPath<P>::I32 InitialPath<P>::newest_keyframe() const {
  const auto& graph = state_.graph_in_l2;
  return state_.started ? I32(graph.keyframe_ids[graph.newest_keyframe()]) : I32(-1);
}

/// Of this serial number, if the map has it.
template <class P>
std::optional<KeyframeState<P>> InitialPath<P>::keyframe(I32 id) const {
  const auto& graph = state_.graph_in_l2;
  for (int k : P::range(0, work::value(graph.keyframe_count()))) {
    const I32 slot = graph.keyframe_slot(k);
    if (I32(graph.keyframe_ids[slot]) == id) return graph.keyframe(slot);
  }
  return std::nullopt;
}

template <class P>
void InitialPath<P>::take_motion(float dt) {
  if (frames_ == 0) return;
  now_s_ = count_ > 0 ? now_s_ + dt : 0;
  taken_s_[static_cast<std::size_t>(count_ % frames_)] = now_s_;  // uncounted: a place a frame
  work::Machine& machine = state_.machine;
  const work::Arena::Frame memory(machine.local());
  const auto stage = machine.stage(stages::kGuided);
  const auto record = machine.local().template alloc<Floats>("IMU interval", kFloats);
  const int at = count_ % frames_;
  since_[at] = newest_keyframe();  // uncounted: a place a frame
  if (!state_.started) return;
  machine.copy_in(record, state_.keyframe.interval.subspan(0, kFloats));
  machine.copy_out(motions_.subspan(at * kFloats, kFloats), record);
}

template <class P>
void InitialPath<P>::remember() {
  if (frames_ == 0) return;
  const auto stage = state_.machine.stage(stages::kGuided);
  became_[count_++ % frames_] = newest_keyframe();  // uncounted: a place a frame
}

template <class P>
std::vector<EarlierPose> InitialPath<P>::poses(float dt) const {
  std::vector<EarlierPose> poses;
  if (count_ == 0) return poses;
  work::Machine& machine = state_.machine;
  const work::Arena::Frame memory(machine.local());
  const auto stage = machine.stage(stages::kGuided);
  const auto record = machine.local().template alloc<Floats>("IMU interval", kFloats);
  std::optional<KeyframeState<P>> state = keyframe(newest_keyframe());
  // uncounted: a round for each frame that waits, once a map
  for (int n = count_ - 1; n >= std::max(0, count_ - frames_) && state; --n) {
    const int at = n % frames_;
    if (now_s_ + dt - taken_s_[static_cast<std::size_t>(at)] > state_.profile.initial_wait) break;
    const I32 since = since_[at], became = became_[at];  // uncounted: places a frame
    machine.copy_in(record, motions_.subspan(at * kFloats, kFloats));
    const auto motion = [&] {
      return Preintegration<P>(record).corrected(state_.graph_in_l2.bias());
    };
    const bool is_keyframe = bool(became != since);
    const Pose<P> pose = is_keyframe ? state->T_world_camera : inertial_.moved_on(*state, motion());
    poses.push_back({plain(pose), count_ - n});
    if (!is_keyframe) continue;
    if (since < I32(0)) break;
    const std::optional<KeyframeState<P>> before = keyframe(since);
    state = before ? before : inertial_.moved_back(*state, motion());
  }
  return poses;
}

template class InitialPath<work::Native>;
template class InitialPath<work::Counting>;

}  // namespace leviosim::vio
