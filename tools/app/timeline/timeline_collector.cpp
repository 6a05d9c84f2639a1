#include "tools/app/timeline/timeline_collector.h"

#include <fmt/core.h>

#include <algorithm>

#include "sim/base/check.h"
#include "sim/chip/chip.h"
#include "sim/soc/run_account.h"
#include "tools/app/result/energy_summary.h"

namespace leviosim::tools {
namespace {

StepKind kind_of(const work::Step& step) {
  if (std::holds_alternative<work::Serial>(step)) return StepKind::Serial;
  if (std::holds_alternative<work::Fork>(step)) return StepKind::Fork;
  if (std::holds_alternative<work::Transfer>(step)) return StepKind::Transfer;
  return StepKind::Wait;
}

/// Absent where the energy is not known.
std::optional<Watts> power_in(const std::optional<RunEnergy>& energy, std::string_view stage) {
  if (!energy) return std::nullopt;
  const auto row = std::find_if(energy->rows.begin(), energy->rows.end(),
                                [&](const EnergyRow& r) { return r.name == stage; });
  if (row == energy->rows.end()) return std::nullopt;
  const std::optional<sim::Estimate<Watts>> power = row->power();
  return power ? std::optional(power->value) : std::nullopt;
}

}  // namespace

TimelineCollector::TimelineCollector(const sim::ChipConfig& chip, int cores,
                                     std::optional<traces::FrameRange> range, int middle)
    : middle_(middle), events_{sim::timebase_of(chip), cores, range, {}, {}} {
  job_run_.chip = chip;
  job_run_.cores = cores;
}

void TimelineCollector::on_start(const RunSubject&, int frames) {
  if (middle_ > 0 && frames > middle_) {
    const auto begin = static_cast<std::size_t>((frames - middle_) / 2);
    events_.range = traces::FrameRange{begin, begin + static_cast<std::size_t>(middle_)};
  }
  if (events_.range)
    traces::check_frame_range(*events_.range, static_cast<std::size_t>(frames),
                              "--timeline-frames: the run");
}

void TimelineCollector::on_front_end(const FrontEndJob& job) {
  if (!events_.holds(job.frame)) return;
  FrameEvents& frame = events_.frames.emplace_back();
  frame.frame = job.frame;
  frame.result = job.result;
  frame.optimisation_begun = job.optimisation_begun;
  frame.work_begin =
      job.parallel.stages.empty() ? job.parallel.begin : job.parallel.stages.front().begin;
  frame.stages = stages_of(job.job, job.parallel, false);
}

void TimelineCollector::on_optimiser(const OptimiserJob& job) {
  if (!events_.holds(job.frame)) return;
  events_.iterations.push_back({job.frame, job.iteration, job.last, job.timing.begin,
                                job.timing.end, stages_of(job.job, job.timing, true)});
}

void TimelineCollector::forget() {
  events_.frames.clear();
  events_.iterations.clear();
}

std::vector<StageEvents> TimelineCollector::stages_of(const work::Job& job,
                                                      const sim::JobTiming& timing,
                                                      bool on_controller) {
  std::vector<StageResult> names;
  for (const work::StageRun& run : job.stages) {
    StageResult& stage = names.emplace_back();
    stage.name = run.stage;
    stage.on_controller = on_controller;
  }
  soc::RunAccount account(std::move(names), job_run_.chip);
  account.add_work(job);
  account.add_parallel(timing);
  job_run_.stages = account.stages();
  const std::optional<RunEnergy> energy = energy_of(job_run_);

  check_equal(job.stages.size(), timing.stages.size(), "stages of a job that were timed");
  std::vector<StageEvents> stages;
  for (std::size_t i = 0; i < job.stages.size(); ++i) {
    const sim::StageTiming& timed = timing.stages[i];
    StageEvents& stage = stages.emplace_back(StageEvents{
        timed.stage, timed.begin, timed.end, timed.cycles, job.stages[i].memory.parallel});
    stage.power = power_in(energy, timed.stage);
    for (const sim::StepTiming& step : timed.steps)
      stage.steps.push_back(step_of(step, on_controller ? "controller" : "cluster"));
  }
  return stages;
}

StepEvents TimelineCollector::step_of(const sim::StepTiming& timing, std::string_view clock) const {
  const auto cycles = [&](sim::Time begin, sim::Time end) {
    return events_.timebase.clock(clock).whole_cycles(end - begin);
  };
  StepEvents step;
  step.kind = kind_of(*timing.step);
  step.begin = timing.begin;
  step.end = timing.end;
  step.cycles = cycles(timing.begin, timing.end);
  step.synchronisation = timing.synchronisation;
  if (step.kind == StepKind::Serial) step.serial = step.cycles;
  if (step.kind == StepKind::Transfer || step.kind == StepKind::Wait) step.transfer = step.cycles;
  if (const auto* fork = std::get_if<work::Fork>(timing.step)) step.name = fork->name;
  if (const auto* transfer = std::get_if<work::Transfer>(timing.step))
    step.transfers.push_back({.direction = transfer->direction,
                              .begin = timing.data.begin,
                              .end = timing.data.end,
                              .bytes = transfer->bytes,
                              .tiles = transfer->background ? 1 : 0});
  for (const sim::CoreTiming& core : timing.cores) {
    const bool is_master = core.core == events_.cores;
    step.cores.push_back({core.core, core.begin, core.end, cycles(core.begin, core.end),
                          is_master ? Cycles(0) : cycles(core.end, timing.end), core.time});
  }
  std::sort(step.cores.begin(), step.cores.end(),
            [](const CoreEvents& a, const CoreEvents& b) { return a.core < b.core; });
  return step;
}

}  // namespace leviosim::tools
