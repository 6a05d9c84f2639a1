#include "sim/chip/controller.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
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
  ExternalTransfers transfers{.begin = begin, .done = {}};
  for (const work::StageRun& stage : job.stages) {
    StageTiming s{stage.stage, timing.end, {}, {}, {}};
    book(s, stage, transfers);
    timing.end = s.end = s.begin + clock_.duration(s.cycles);
    if (s.end > kLastTime) fail_beyond_time();
    timing.stages.push_back(std::move(s));
  }
  return timing;
}

/// Cycles of a stage, and its account.
void Controller::book(StageTiming& stage, const work::StageRun& run,
                      ExternalTransfers& transfers) const {
  ForkAccount* const fork = keep_forks_ ? &stage.account.fork(kSerialFork) : nullptr;
  const Demand demand = demand_of_stage(run, fork == nullptr ? nullptr : &fork->operations);
  const double begin = transfers.now;
  const double transfer = wait_for_transfers(run, demand.cycles(), stage, transfers);
  stage.cycles = counted_cycles(std::ceil(demand.cycles() + transfer));
  transfers.now = begin + static_cast<double>(stage.cycles.count());
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

namespace {

/// Lets the core wait, if that has not happened yet.
void wait_until(double happens, double& waited, double& now) {
  if (happens <= now) return;
  waited += happens - now;
  now = happens;
}

bool moves_external(const work::Step& step) {
  const auto* transfer = std::get_if<work::Transfer>(&step);
  return transfer != nullptr && !work::is_between_l1_and_l2(transfer->direction);
}

/// What the core does in a step.
work::Counts work_in(const work::Step& step) {
  work::Counts sum;
  if (const auto* serial = std::get_if<work::Serial>(&step)) sum += serial->counts;
  if (const auto* fork = std::get_if<work::Fork>(&step))
    for (const work::Segment& share : fork->shares) sum += static_cast<const work::Counts&>(share);
  return sum;
}

}  // namespace

/// Cycles beside those of the work, which is `work` in all. Only external memory is far from a
/// controller.
double Controller::wait_for_transfers(const work::StageRun& run, double work, StageTiming& stage,
                                      ExternalTransfers& transfers) const {
  const bool external = std::any_of(run.steps.begin(), run.steps.end(), moves_external);
  if (!external && transfers.done.empty()) return 0;
  if (external && config_.external.bytes_per_second <= 0)
    throw InputError(fmt::format(
        "{}: the work moves data from or to external memory, which the platform does not have",
        stage.stage));
  std::vector<double> worked;  // by step; caches make it a little more than its parts
  for (const work::Step& step : run.steps)
    worked.push_back(demand_of(work_in(step), costs_, code_).cycles());
  const double sum = std::accumulate(worked.begin(), worked.end(), 0.0);
  double waited = 0;
  for (std::size_t i = 0; i < run.steps.size(); ++i) {
    if (sum > 0) transfers.now += worked[i] * work / sum;
    if (const auto* wait = std::get_if<work::TransferWait>(&run.steps[i]))
      wait_until(transfers.done.at(static_cast<std::size_t>(wait->number)), waited, transfers.now);
    const auto* transfer = std::get_if<work::Transfer>(&run.steps[i]);
    if (transfer == nullptr) continue;
    const double done =
        moves_external(run.steps[i]) ? pass(run.steps[i], stage, waited, transfers) : transfers.now;
    if (transfer->background)
      transfers.done.push_back(done);
    else
      wait_until(done, waited, transfers.now);
  }
  return waited;
}

double Controller::pass(const work::Step& step, StageTiming& stage, double& waited,
                        ExternalTransfers& transfers) const {
  const ExternalMemoryConfig& memory = config_.external;
  const auto clock = static_cast<double>(config_.clock.count());
  const Bytes moved = std::max(std::get<work::Transfer>(step).bytes, memory.burst);
  const double programmed = transfers.now;
  wait_until(programmed + memory.latency_seconds * clock, waited, transfers.now);
  const double first = std::max(transfers.now, transfers.free);
  transfers.free = first + static_cast<double>(moved.count()) / memory.bytes_per_second * clock;
  if (keep_steps_) {
    const auto at = [&](double cycle) {
      return transfers.begin + clock_.duration(Cycles(static_cast<std::int64_t>(cycle)));
    };
    stage.steps.push_back({.step = &step,
                           .begin = at(programmed),
                           .end = at(transfers.now),
                           .data = {at(first), at(transfers.free)}});
  }
  return transfers.free;
}

}  // namespace leviosim::sim
