#include "workload/pipeline/back_end.h"

#include "workload/pipeline/stages.h"

namespace leviosim::vio {

template <class P>
BackEnd<P>::BackEnd(const Profile& profile, work::Machine& controller, const PoseGraph<P>& graph)
    : profile_(profile),
      machine_(controller),
      graph_(graph),
      window_(controller.local(), graph.capacity),
      damping_(profile.optimiser) {}

template <class P>
bool BackEnd<P>::begin() {
  if (work::value(graph_.keyframe_count()) < 2) return false;
  const auto stage = machine_.stage(stages::kOptimiserUpdate);
  if (profile_.use_imu)
    absorb_departed_intervals<P>(window_, graph_, profile_.imu_noise, profile_.biases);
  take_snapshot<P>(graph_, profile_.imu_noise, machine_.local(), window_);
  damping_ = LmState<P>(profile_.optimiser);
  return true;
}

template <class P>
OptimiserReport BackEnd<P>::optimise() {
  const auto stage = machine_.stage(stages::kOptimiser);
  const IterationReport report = optimise_once<P>(machine_, window_, damping_, profile_.optimiser);
  return {true, report.accepted, report.cost_before, report.cost_after};
}

template <class P>
void BackEnd<P>::publish() {
  const auto stage = machine_.stage(stages::kOptimiserUpdate);
  if (profile_.use_imu) estimate_biases<P>(window_, profile_.imu_noise, profile_.biases);
  const int last = window_.keyframes - 1;
  const I32 slot = window_.keyframe_slots[last];
  const bool still_there = bool(I32(graph_.keyframe_ids[slot]) == I32(window_.keyframe_ids[last]));
  const Pose<P> before = graph_.keyframe(slot).T_world_camera;
  vio::publish<P>(window_, graph_);
  if (still_there) move_newer_keyframes(window_.state.pose(last) * inverse(before));
}

/// Keyframes added since the snapshot were placed relative to the last one in it: they follow it.
template <class P>
void BackEnd<P>::move_newer_keyframes(const Pose<P>& T_new_old) {
  const int last = window_.keyframes - 1;
  const I32 last_id = window_.keyframe_ids[last];
  for (int k : P::range(0, work::value(graph_.keyframe_count()))) {
    const I32 slot = graph_.keyframe_slot(k);
    if (I32(graph_.keyframe_ids[slot]) <= last_id) continue;
    const KeyframeState<P> state = graph_.keyframe(slot);
    graph_.set_keyframe(slot, {T_new_old * state.T_world_camera, T_new_old.R * state.velocity});
  }
}

template class BackEnd<work::Native>;
template class BackEnd<work::Counting>;

}  // namespace leviosim::vio
