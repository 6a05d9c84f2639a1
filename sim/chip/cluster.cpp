#include "sim/chip/cluster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/events/last_time.h"
#include "sim/events/timebase.h"

namespace leviosim::sim {
namespace {

int checked_workers(const ClusterConfig& config, int workers) {
  if (workers == Cluster::kMasterAlone) return 0;
  if (workers < 1 || workers > config.max_workers)
    throw InputError(fmt::format("a team of {} workers: the event unit serves 1 to {}", workers,
                                 config.max_workers));
  return workers;
}

OperationAccounts* operations_of(ForkAccount* fork) {
  return fork == nullptr ? nullptr : &fork->operations;
}

/// Books what a share took, or what the team waited for.
void book(CycleAccount& account, ForkAccount* fork, const MechanismCycles& cycles) {
  account.team += cycles;
  if (fork != nullptr) fork->cycles += cycles;
}

void book(CycleAccount& account, ForkAccount* fork, Mechanism mechanism, double core_cycles) {
  account.team[mechanism] += core_cycles;
  if (fork != nullptr) fork->cycles[mechanism] += core_cycles / fork->weight;
}

/// Cycles that a model gives as a real number.
Cycles whole(double cycles) { return counted_cycles(std::round(cycles)); }

}  // namespace

Cluster::Cluster(Kernel& kernel, const ClockDomain& clock, const ClusterConfig& config, int workers)
    : kernel_(kernel),
      clock_(clock),
      config_(config),
      workers_(checked_workers(config, workers)),
      team_(config, workers_),
      dma_(config.dma),
      sums_(static_cast<std::size_t>(workers_)) {}

Task<JobTiming> Cluster::run(const work::Job& job) {
  JobTiming timing = time(job, kernel_.now());
  co_await kernel_.at(timing.end);
  co_return timing;
}

JobTiming Cluster::time(const work::Job& job, Time begin) {
  job_begin_ = begin;
  now_ = {};
  background_.clear();
  dma_.begin_job();
  after_fork_ = false;
  JobTiming timing{begin, begin, {}};
  timing.stages.reserve(job.stages.size());
  for (const work::StageRun& stage : job.stages) timing.stages.push_back(time_stage(stage));
  timing.end = at(now_);
  return timing;
}

StageTiming Cluster::time_stage(const work::StageRun& stage) {
  const Cycles begin = now_;
  StageTiming timing{stage.stage, at(begin), {}, {}, {}};
  if (keep_steps_) timing.steps.reserve(stage.steps.size());
  for (const work::Step& variant : stage.steps) {
    if (keep_steps_) step_ = &timing.steps.emplace_back(StepTiming{&variant, at(now_), {}});
    std::visit([&](const auto& of_kind) { step(of_kind, timing.account); }, variant);
    if (StepTiming* ended = std::exchange(step_, nullptr)) ended->end = at(now_);
    after_fork_ = std::holds_alternative<work::Fork>(variant);
  }
  timing.end = at(now_);
  timing.cycles = now_ - begin;
  return timing;
}

void Cluster::note(const TeamShare& share) {
  if (step_ != nullptr)
    step_->cores.push_back({share.core, at(share.begin), at(share.end), share.time});
}

ForkAccount* Cluster::fork_in(CycleAccount& account, std::string_view name, double weight) const {
  return keep_forks_ ? &account.fork(name, weight) : nullptr;
}

MechanismCycles Cluster::execute(const work::Segment& segment, OperationAccounts* by_operation,
                                 const void* step) {
  TeamShare share{workers_, &segment, now_, by_operation};
  team_.execute({&share, 1}, dma_.traffic(), step);
  now_ = share.end;
  note(share);
  return share.time;
}

void Cluster::step(const work::Serial& serial, CycleAccount& account) {
  const Cycles begin = now_;
  ForkAccount* const fork = fork_in(account, kSerialFork, accounted());
  const MechanismCycles time = execute(serial.counts, operations_of(fork), &serial);
  account.team[Mechanism::Serial] += accounted() * cycles_since(begin);
  if (fork != nullptr) fork->cycles += time;
}

void Cluster::step(const work::Transfer& transfer, CycleAccount& account) {
  const Cycles begin = now_;
  now_ = later(std::max(now_, dma_.room(now_)), whole(config_.dma.programming));
  const Interval data = dma_.start(transfer, now_);
  if (step_ != nullptr) step_->data = {at(data.begin), at(data.end)};
  now_ = later(now_, whole(config_.dma.call));
  if (transfer.background)
    background_.push_back(data.end);
  else
    until_arrived(data.end);
  book_transfer(account, begin);
}

void Cluster::step(const work::TransferWait& wait, CycleAccount& account) {
  const Cycles begin = now_;
  until_arrived(background_.at(static_cast<std::size_t>(wait.number)));
  book_transfer(account, begin);
}

void Cluster::book_transfer(CycleAccount& account, Cycles begin) {
  book(account, fork_in(account, "", accounted()), Mechanism::Transfer,
       accounted() * cycles_since(begin));
}

/// A core sleeps on the wait instruction even if the event is there already
/// (FACTS.md#synchronisation).
void Cluster::until_arrived(Cycles arrival) {
  now_ = later(std::max(now_, arrival), whole(config_.dma.completion));
}

void Cluster::step(const work::Fork& fork, CycleAccount& account) {
  if (workers_ == 0) return run_alone(fork, account);
  const Cycles begin = now_;
  ForkAccount* const of_fork = fork_in(account, fork.name, 1);
  const double part = after_fork_ ? config_.events.fork_again : 1;
  const Cycles dispatched = later(begin, whole(part * config_.events.fork_master));
  const Cycles started = later(dispatched, whole(part * config_.events.fork_worker));
  const std::span<TeamShare> shares = shares_of(fork, started, dispatched, of_fork);
  team_.execute(shares, dma_.traffic(), &fork);
  now_ = dispatched;
  Cycles last_arrival;
  double arrivals = 0;  // of the workers after the begin of the fork, summed
  std::sort(shares.begin(), shares.end(), [](const TeamShare& a, const TeamShare& b) {
    return a.end != b.end ? a.end < b.end : a.core < b.core;
  });
  for (const TeamShare& share : shares) {
    now_ = share.end;
    note(share);
    if (share.core == workers_) continue;
    book(account, of_fork, share.time);
    last_arrival = share.end;
    arrivals += cycles_since(begin);
  }
  now_ = later(now_, whole(config_.events.barrier));
  const auto last = static_cast<double>((last_arrival - begin).count());
  const auto start_up = static_cast<double>((started - begin).count());
  const double after = cycles_since(last_arrival);
  const double barrier = std::min(after, config_.events.barrier);
  book(account, of_fork, Mechanism::Imbalance, workers_ * (last + after - barrier) - arrivals);
  book(account, of_fork, Mechanism::Synchronisation, workers_ * (start_up + barrier));
  if (step_ != nullptr) step_->synchronisation = start_up + barrier;
}

std::span<TeamShare> Cluster::shares_of(const work::Fork& fork, Cycles of_workers, Cycles of_master,
                                        ForkAccount* of_fork) {
  shares_.clear();
  for (int id = 0; id < workers_; ++id)
    shares_.push_back({id, &shares_of(id, fork), of_workers, operations_of(of_fork)});
  if (fork.master_takes_part) shares_.push_back({workers_, &fork.shares.back(), of_master});
  return shares_;
}

void Cluster::run_alone(const work::Fork& fork, CycleAccount& account) {
  const work::Segment sum = work::shares_on_one_core(fork);
  ForkAccount* const of_fork = fork_in(account, fork.name, 1);
  book(account, of_fork, execute(sum, operations_of(of_fork), &fork));
}

const work::Segment& Cluster::shares_of(int id, const work::Fork& fork) {
  const std::size_t shares = fork.shares.size() - (fork.master_takes_part ? 1 : 0);
  const auto first = static_cast<std::size_t>(id);
  const auto step = static_cast<std::size_t>(workers_);
  if (first < shares && first + step >= shares) return fork.shares[first];
  work::Segment& sum = sums_[first];
  sum = {};
  for (std::size_t k = first; k < shares; k += step) sum += fork.shares[k];
  return sum;
}

}  // namespace leviosim::sim
