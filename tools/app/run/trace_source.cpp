#include "tools/app/run/trace_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/chip/accelerator.h"

namespace leviosim::tools {
namespace {

PoseSource source_of(const traces::WorkFrame& frame, const traces::WorkTrace& trace, int number) {
  if (const auto source = vio::source_named(frame.source)) return *source;
  throw InputError(
      fmt::format("{}: frame {} has its pose from '{}', which this leviosim does not know",
                  trace.name(), number, frame.source));
}

/// What the facts of the trace are called here; null for one that this program does not know.
std::vector<const vio::FrameFact*> known_facts(const traces::WorkTraceInfo& info) {
  std::vector<const vio::FrameFact*> facts;
  for (const std::string& name : info.facts) {
    const auto fact = std::find_if(vio::kFrameFacts.begin(), vio::kFrameFacts.end(),
                                   [&](const vio::FrameFact& f) { return f.name == name; });
    facts.push_back(fact == vio::kFrameFacts.end() ? nullptr : &*fact);
  }
  return facts;
}

}  // namespace

TraceSource::TraceSource(const traces::WorkTrace& trace, Bytes l1, Bytes l2, bool offload,
                         std::optional<work::CompiledFor> code)
    : trace_(trace),
      l1_(l1),
      l2_(l2),
      reader_(trace, offload, code),
      facts_(known_facts(trace.info())) {}

bool TraceSource::begin_frame(const soc::FrameStart& start) {
  for (; number_ < start.frame; ++number_)
    check(reader_.next(frame_), "a trace has as many frames as it has time stamps");
  const std::int64_t arrival_ns = time_ns(start.frame) - time_ns(0);
  const bool begun = frame_.optimised && !start.optimiser_busy;
  comparisons_.push_back(
      {start.frame,
       {frame_.start_ns - arrival_ns, frame_.optimiser_busy, frame_.optimised, frame_.seen},
       {start.start_ns - arrival_ns, start.optimiser_busy, begun, start.seen}});
  if (begun) {
    std::swap(iterations_, frame_.iterations);
    next_iteration_ = 0;
  }
  return begun;
}

const work::Job& TraceSource::process(FrameResult& result) {
  result.index = frame_.index;
  result.t_ns = frame_.t_ns;
  result.source = source_of(frame_, trace_, number_);
  result.keyframe = frame_.keyframe;
  for (std::size_t i = 0; i < facts_.size(); ++i)
    if (facts_[i] != nullptr) result.*facts_[i]->of = frame_.facts[i];
  result.pose = {frame_.t_ns, frame_.T_world_body};
  check_fits(frame_.front_end, "L1", l1_);
  return frame_.front_end;
}

const work::Job& TraceSource::optimise() {
  const work::Job& job = iterations_.at(next_iteration_++);
  check_fits(job, "L2", l2_);
  return job;
}

void TraceSource::check_fits(const work::Job& job, const char* memory, Bytes size) const {
  for (const work::StageRun& stage : job.stages)
    if (stage.memory.parallel > size)
      throw InputError(fmt::format(
          "{}: frame {}, {}: the recorded work occupies {} bytes of {}, which has {}: {} bytes are "
          "missing; a larger {} has them",
          trace_.name(), number_, stage.stage, stage.memory.parallel.count(), memory, size.count(),
          (stage.memory.parallel - size).count(),
          std::string_view(memory) == "L2" ? "l2.size" : "cluster.l1.size"));
}

std::vector<StageResult> TraceSource::empty_stages() const {
  std::vector<StageResult> stages;
  for (const traces::WorkTraceInfo::Stage& recorded : trace_.info().stages) {
    StageResult stage;
    stage.name = recorded.name;
    stage.unit = recorded.unit;
    stage.on_controller = recorded.on_controller;
    stages.push_back(std::move(stage));
  }
  return stages;
}

void TraceSource::describe(RunResult& result) const { describe_recording(trace_, result); }

void describe_recording(const traces::WorkTrace& trace, RunResult& result) {
  const traces::WorkTraceInfo& info = trace.info();
  result.profile = info.profile;
  result.frame_period_ns = info.frame_period_ns;
  result.image_width = info.image_width;
  result.image_height = info.image_height;
  for (const traces::WorkTraceInfo::Memory& memory : info.l2)
    result.l2.push_back({memory.name, memory.bytes, memory.blocks});
  result.ate = info.ate;
}

void check_cores(const traces::WorkTrace& trace, const RunRequest& request) {
  const int recorded = trace.info().cores;
  const int most = request.platform.config.cluster.workers;
  if (recorded > most)
    throw InputError(fmt::format(
        "{}: its work was divided among {} cores; {} has {}, expected as many (cluster.workers={})",
        trace.name(), recorded, request.platform.name, most, recorded));
  if (request.cores != recorded)
    throw InputError(fmt::format(
        "{}: its work was divided among {} cores, and how a program divides its work among {} is "
        "not in it; replay with --cores {}, or record again with run --record --cores {}",
        trace.name(), recorded, request.cores, recorded, request.cores));
}

platform::ResolvedPlatform recorded_platform(const traces::WorkTrace& trace,
                                             const std::vector<std::string>& overrides) {
  return platform::resolve_platform_text(trace.name() + ", platform of the recording",
                                         trace.info().platform_yaml, overrides);
}

Replay replay(const traces::WorkTrace& trace, const RunRequest& request,
              const ProgressCallback& progress) {
  check_cores(trace, request);
  const auto begin = std::chrono::steady_clock::now();
  const sim::ChipConfig& chip = request.platform.config;
  TraceSource source(trace, chip.cluster.l1.size, chip.l2.size, sim::has_accelerators(chip),
                     sim::code_of(chip));
  Replay result;
  result.run = simulate_source(request, source, progress);
  result.run.host_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  result.frames = source.comparisons();
  result.recorded_l1 = recorded_platform(trace).config.cluster.l1.size;
  return result;
}

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
  for (const L2Row& row : result.l2) info.l2.push_back({row.name, row.bytes, row.blocks});
  info.ate = result.ate;
}

}  // namespace leviosim::tools
