#include "sim/soc/run_account.h"

#include <algorithm>

#include "sim/chip/accelerator.h"

namespace leviosim::soc {

StageResult& RunAccount::find(std::string_view name) {
  const auto it = std::find_if(stages_.begin(), stages_.end(),
                               [&](const StageResult& s) { return s.name == name; });
  if (it != stages_.end()) return *it;
  StageResult stage;
  stage.name = name;
  return stages_.emplace_back(std::move(stage));
}

void RunAccount::add_work(const work::Job& job) {
  for (const work::StageRun& run : job.stages) {
    StageResult& stage = find(run.stage);
    ++stage.calls;
    add_segments(run, stage);
    add_unmeasured(run, stage);
    stage.transfers += work::transferred_by(run);
    stage.memory.single = std::max(stage.memory.single, run.memory.single);
    if (run.memory.parallel > stage.memory.parallel) {
      stage.memory.parallel = run.memory.parallel;
      stage.memory.blocks = run.memory.blocks;
    }
  }
}

/// What it costs a core that runs alone, if no function that it visits was measured.
double RunAccount::unmeasured_cycles(const work::Segment& segment, bool on_controller) const {
  const sim::CoreCosts& core = on_controller ? controller_core_ : cluster_core_;
  if (sim::is_measured(work::compiled_of(segment.compiled, core.code))) return 0;
  return sim::demand_of(segment, core, on_controller ? controller_ : cluster_).cycles();
}

void RunAccount::add_unmeasured(const work::StageRun& run, StageResult& stage) const {
  for (const work::Step& step : run.steps) {
    if (const auto* serial = std::get_if<work::Serial>(&step))
      stage.unmeasured += unmeasured_cycles(serial->counts, stage.on_controller);
    if (const auto* fork = std::get_if<work::Fork>(&step))
      for (const work::Segment& share : fork->shares)
        stage.unmeasured += unmeasured_cycles(share, stage.on_controller);
  }
}

void RunAccount::add_segments(const work::StageRun& run, StageResult& stage) const {
  const sim::Accelerators& accelerators = stage.on_controller ? controller_ : cluster_;
  if (!sim::has_accelerators(accelerators)) {
    stage.counts += work::counts_of(run);
    return;
  }
  work::Segment segment = work::segments_of(run);
  stage.counts += sim::left_to_core(segment, accelerators);
  std::erase_if(segment.offload, [&](const work::OffloadWork& calls) {
    return accelerators[work::index(calls.kernel)].units == 0;
  });
  work::Segment sum({}, std::move(stage.served));
  sum += work::Segment({}, std::move(segment.offload));
  stage.served = std::move(sum.offload);
}

void RunAccount::add_parallel(const sim::JobTiming& timing) {
  for (const sim::StageTiming& run : timing.stages) {
    StageResult& stage = find(run.stage);
    stage.parallel += run.cycles;
    stage.worst_parallel = std::max(stage.worst_parallel, run.cycles);
    stage.account += run.account;
  }
}

void RunAccount::add_single(const sim::JobTiming& timing) {
  for (const sim::StageTiming& run : timing.stages) {
    StageResult& stage = find(run.stage);
    stage.single += run.cycles;
    stage.single_account += run.account.team;
  }
}

void RunAccount::add_offload(Cycles whole, const sim::JobTiming& timing) {
  offload_ += whole;
  for (const sim::StageTiming& stage : timing.stages) offload_ -= stage.cycles;
}

}  // namespace leviosim::soc
