#include "tools/app/run/trace_source.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/work/arena.h"

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
  check_fits(trace_, number_, frame_.front_end, "L1", l1_);
  return frame_.front_end;
}

const work::Job& TraceSource::optimise() {
  const work::Job& job = iterations_.at(next_iteration_++);
  check_fits(trace_, number_, job, "L2", l2_);
  return job;
}

void check_fits(const traces::WorkTrace& trace, int frame, const work::Job& job, const char* memory,
                Bytes size) {
  for (const work::StageRun& stage : job.stages)
    if (stage.memory.parallel > size)
      throw work::MemoryOverflow(
          fmt::format("{}: frame {}, {}: the recorded work occupies {} bytes of {}, which has {}: "
                      "{} bytes are missing; a larger {} has them",
                      trace.name(), frame, stage.stage, stage.memory.parallel.count(), memory,
                      size.count(), (stage.memory.parallel - size).count(),
                      std::string_view(memory) == "L2" ? "l2.size" : "cluster.l1.size"),
          memory);
}

std::vector<StageResult> stages_of(const traces::WorkTrace& trace) {
  std::vector<StageResult> stages;
  for (const traces::WorkTraceInfo::Stage& recorded : trace.info().stages) {
    StageResult stage;
    stage.name = recorded.name;
    stage.unit = recorded.unit;
    stage.on_controller = recorded.on_controller;
    stages.push_back(std::move(stage));
  }
  return stages;
}

void TraceSource::describe(RunResult& result) const { describe_recording(trace_, result); }

RunSubject subject_of(const traces::WorkTrace& trace) {
  const traces::WorkTraceInfo& info = trace.info();
  return {info.profile, info.frame_period_ns, info.image_width, info.image_height};
}

void describe_recording(const traces::WorkTrace& trace, RunResult& result) {
  const traces::WorkTraceInfo& info = trace.info();
  for (const traces::WorkTraceInfo::Memory& memory : info.l2)
    (memory.name == kOptimiserExternal ? result.external : result.l2)
        .push_back({memory.name, memory.bytes, memory.blocks});
  result.ate = info.ate;
}

}  // namespace leviosim::tools
