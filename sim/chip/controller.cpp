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
  ExternalTransfers transfers;
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
  const double transfer = wait_for_transfers(run, demand.cycles(), transfers);
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
double Controller::wait_for_transfers(const work::StageRun& stage, double work,
                                      ExternalTransfers& transfers) const {
  const ExternalMemoryConfig& memory = config_.external;
  const bool external = std::any_of(stage.steps.begin(), stage.steps.end(), moves_external);
  if (!external && transfers.done.empty()) return 0;
  if (external && memory.bytes_per_second <= 0)
    throw InputError(fmt::format(
        "{}: the work moves data from or to external memory, which the platform does not have",
        stage.stage));
  std::vector<double> worked;  // by step; caches make it a little more than its parts
  for (const work::Step& step : stage.steps)
    worked.push_back(demand_of(work_in(step), costs_, code_).cycles());
  const double sum = std::accumulate(worked.begin(), worked.end(), 0.0);
  const double clock = static_cast<double>(config_.clock.count());
  double waited = 0;
  for (std::size_t i = 0; i < stage.steps.size(); ++i) {
    if (sum > 0) transfers.now += worked[i] * work / sum;
    if (const auto* wait = std::get_if<work::TransferWait>(&stage.steps[i]))
      wait_until(transfers.done.at(static_cast<std::size_t>(wait->number)), waited, transfers.now);
    const auto* transfer = std::get_if<work::Transfer>(&stage.steps[i]);
    if (transfer == nullptr) continue;
    double done = transfers.now;
    if (moves_external(stage.steps[i])) {
      const Bytes moved = std::max(transfer->bytes, memory.burst);
      wait_until(transfers.now + memory.latency_seconds * clock, waited, transfers.now);
      done = transfers.free = std::max(transfers.now, transfers.free) +
                              static_cast<double>(moved.count()) / memory.bytes_per_second * clock;
    }
    if (transfer->background)
      transfers.done.push_back(done);
    else
      wait_until(done, waited, transfers.now);
  }
  return waited;
}

}  // namespace leviosim::sim
