#include "sim/chip/controller.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/base/error.h"
#include "sim/chip/accelerator.h"
#include "sim/events/last_time.h"
#include "sim/events/timebase.h"

namespace leviosim::sim {

Task<JobTiming> Controller::run(const work::Job& job) {
  JobTiming timing = time(job, kernel_.now());
  co_await kernel_.at(timing.end);
  co_return timing;
}

JobTiming Controller::time(const work::Job& job, Time begin) const {
  JobTiming timing{begin, begin, {}};
  for (const work::StageRun& stage : job.stages) {
    StageTiming s{stage.stage, timing.end, {}, {}, {}};
    book(s, stage);
    timing.end = s.end = s.begin + clock_.duration(s.cycles);
    if (s.end > kLastTime) fail_beyond_time();
    timing.stages.push_back(std::move(s));
  }
  return timing;
}

/// Cycles of a stage, and its account.
void Controller::book(StageTiming& stage, const work::StageRun& run) const {
  ForkAccount* const fork = keep_forks_ ? &stage.account.fork(kSerialFork) : nullptr;
  const Demand demand = demand_of_stage(run, fork == nullptr ? nullptr : &fork->operations);
  const double transfer = transfer_cycles(run);
  stage.cycles = counted_cycles(std::ceil(demand.cycles() + transfer));
  MechanismCycles worked;
  worked += demand.alone;
  worked[Mechanism::Rounding] =
      static_cast<double>(stage.cycles.count()) - demand.cycles() - transfer;
  stage.account.team += worked;
  stage.account.team[Mechanism::Transfer] = transfer;
  if (fork == nullptr) return;
  fork->cycles += worked;
  if (transfer != 0) stage.account.fork("").cycles[Mechanism::Transfer] = transfer;
}

Demand Controller::demand_of_stage(const work::StageRun& stage,
                                   OperationAccounts* by_operation) const {
  if (!has_accelerators(config_.accelerators))
    return demand_of(work::counts_of(stage), costs_, code_, by_operation);
  return demand_of(work::segments_of(stage), costs_, config_.accelerators, code_, by_operation);
}

/// Only external memory is far from a controller.
double Controller::transfer_cycles(const work::StageRun& stage) const {
  const ExternalMemoryConfig& memory = config_.external;
  double seconds = 0;
  for (const work::Step& step : stage.steps) {
    const auto* transfer = std::get_if<work::Transfer>(&step);
    if (transfer == nullptr || work::is_between_l1_and_l2(transfer->direction)) continue;
    if (memory.bytes_per_second <= 0)
      throw InputError(fmt::format(
          "{}: the work moves data from or to external memory, which the platform does not have",
          stage.stage));
    const Bytes moved = std::max(transfer->bytes, memory.burst);
    seconds +=
        memory.latency_seconds + static_cast<double>(moved.count()) / memory.bytes_per_second;
  }
  return seconds * static_cast<double>(config_.clock.count());
}

}  // namespace leviosim::sim
