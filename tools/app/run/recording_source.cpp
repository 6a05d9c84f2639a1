#include "tools/app/run/recording_source.h"

#include <algorithm>

#include "sim/base/check.h"

namespace leviosim::tools {

bool RecordingSource::begin_frame(const soc::FrameStart& start) {
  write_complete_frames(source_.frames_that_wait());
  const bool begun = source_.begin_frame(start);
  if (begun) {
    check_equal(iterations_left_, std::size_t{0}, "iterations left of the optimisation before");
    iterations_left_ = static_cast<std::size_t>(source_.iterations());
  }
  traces::WorkFrame& frame = frames_.emplace_back();
  frame.start_ns = start.start_ns;
  frame.optimiser_busy = start.optimiser_busy;
  frame.seen = start.seen;
  frame.optimised = begun;
  return begun;
}

const work::Job& RecordingSource::process(FrameResult& result) {
  const work::Job& job = source_.process(result);
  traces::WorkFrame& frame = frames_.back();
  frame.index = result.index;
  frame.t_ns = result.t_ns;
  frame.source = name_of(result.source);
  frame.keyframe = result.keyframe;
  frame.facts.clear();
  for (const vio::FrameFact& fact : vio::kFrameFacts) frame.facts.push_back(result.*fact.of);
  frame.T_world_body = result.pose.T_world_body;
  frame.front_end = job;
  correct_earlier(result);
  return job;
}

/// As the run itself does (simulate.cpp).
void RecordingSource::correct_earlier(const FrameResult& result) {
  const auto state = static_cast<std::size_t>(
      std::find_if(vio::kFrameFacts.begin(), vio::kFrameFacts.end(),
                   [](const vio::FrameFact& f) { return f.of == &vio::FrameFacts::state; }) -
      vio::kFrameFacts.begin());
  for (const auto& [ago, pose] : result.earlier) {
    traces::WorkFrame& frame = frames_[frames_.size() - 1 - static_cast<std::size_t>(ago)];
    frame.T_world_body = pose.T_world_body;
    frame.facts[state] = vio::state_after(frame.facts[state], result.state);
  }
}

const work::Job& RecordingSource::optimise() {
  const work::Job& job = source_.optimise();
  const auto optimised = std::find_if(frames_.rbegin(), frames_.rend(),
                                      [](const auto& frame) { return frame.optimised; });
  check(optimised != frames_.rend() && iterations_left_ > 0, "an iteration belongs to a frame");
  optimised->iterations.push_back(job);
  --iterations_left_;
  return job;
}

void RecordingSource::write_complete_frames(int waiting) {
  for (; frames_.size() > static_cast<std::size_t>(waiting); frames_.pop_front()) {
    const bool in_progress = frames_.front().optimised && iterations_left_ > 0 &&
                             std::none_of(frames_.begin() + 1, frames_.end(),
                                          [](const auto& frame) { return frame.optimised; });
    if (in_progress) return;
    recording_.writer.add(frames_.front());
  }
}

void RecordingSource::finish() {
  while (iterations_left_ > 0) optimise();
  write_complete_frames(0);
}

void RecordingSource::describe(RunResult& result) const {
  source_.describe(result);
  traces::WorkTraceInfo& info = recording_.info;
  info.profile = result.profile;
  info.image_width = result.image_width;
  info.image_height = result.image_height;
  info.frame_period_ns = result.frame_period_ns;
  for (const vio::FrameFact& fact : vio::kFrameFacts) info.facts.emplace_back(fact.name);
  for (const StageResult& stage : empty_stages())
    info.stages.push_back({stage.name, stage.unit, stage.on_controller});
  for (const std::vector<L2Row>* memory : {&result.l2, &result.external})
    for (const L2Row& row : *memory) info.l2.push_back({row.name, row.bytes, row.blocks});
  info.ate = result.ate;
}

}  // namespace leviosim::tools
