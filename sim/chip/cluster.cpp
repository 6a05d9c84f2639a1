#include "sim/chip/cluster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/base/check.h"
#include "sim/base/error.h"
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

}  // namespace

Cluster::Cluster(Kernel& kernel, const ClockDomain& clock, const ClusterConfig& config, int workers)
    : kernel_(kernel),
      clock_(clock),
      config_(config),
      workers_(checked_workers(config, workers)),
      team_(kernel, clock, config, workers_),
      dma_(kernel, clock, config.dma, team_),
      end_of_fork_(kernel, "end of fork", static_cast<std::size_t>(workers_) + 1,
                   cycles(config.events.barrier)) {
  for (int id = 0; id < workers_; ++id) {
    dispatch_.push_back(
        std::make_unique<Channel<Dispatch>>(kernel_, fmt::format("dispatch to core {}", id), 1));
    kernel_.spawn_server(fmt::format("core {}", id), worker(id));
  }
}

Duration Cluster::cycles(double n) const { return clock_.duration(counted_cycles(std::round(n))); }

double Cluster::cycles_since(Time begin, Time end) const {
  return static_cast<double>(clock_.whole_cycles(end - begin).count());
}

Task<JobTiming> Cluster::run(const work::Job& job) {
  JobTiming timing{kernel_.now(), kernel_.now(), {}};
  background_.clear();
  after_fork_ = false;
  for (const work::StageRun& stage : job.stages) {
    StageTiming s{stage.stage, kernel_.now(), {}, {}, {}};
    for (const work::Step& variant : stage.steps) {
      begin_step(variant, s);
      // Not std::visit: a coroutine must not be awaited inside a plain lambda.
      if (const auto* serial = std::get_if<work::Serial>(&variant))
        co_await step(*serial, s.account);
      else if (const auto* fork = std::get_if<work::Fork>(&variant))
        co_await step(*fork, s.account);
      else if (const auto* transfer = std::get_if<work::Transfer>(&variant))
        co_await step(*transfer, s.account);
      else
        co_await step(std::get<work::TransferWait>(variant), s.account);
      end_step();
      after_fork_ = std::holds_alternative<work::Fork>(variant);
    }
    s.end = kernel_.now();
    s.cycles = clock_.whole_cycles(s.end - s.begin);
    timing.stages.push_back(std::move(s));
  }
  timing.end = kernel_.now();
  co_return timing;
}

void Cluster::begin_step(const work::Step& step, StageTiming& stage) {
  if (keep_steps_) step_ = &stage.steps.emplace_back(StepTiming{&step, kernel_.now(), {}});
}

void Cluster::end_step() {
  if (StepTiming* ended = std::exchange(step_, nullptr)) ended->end = kernel_.now();
}

void Cluster::note(int core, Time begin, const MechanismCycles& time) {
  if (step_ != nullptr) step_->cores.push_back({core, begin, kernel_.now(), time});
}

ForkAccount* Cluster::fork_in(CycleAccount& account, std::string_view name, double weight) const {
  return keep_forks_ ? &account.fork(name, weight) : nullptr;
}

Task<> Cluster::step(const work::Serial& serial, CycleAccount& account) {
  const Time begin = kernel_.now();
  ForkAccount* const fork = fork_in(account, kSerialFork, accounted());
  const MechanismCycles time = co_await team_.execute(workers_, serial.counts, operations_of(fork));
  note(workers_, begin, time);
  account.team[Mechanism::Serial] += accounted() * cycles_since(begin, kernel_.now());
  if (fork != nullptr) fork->cycles += time;
}

Task<> Cluster::step(const work::Transfer& transfer, CycleAccount& account) {
  const Time begin = kernel_.now();
  if (const Time room = dma_.room(); room > begin) co_await kernel_.at(room);
  co_await kernel_.delay(cycles(config_.dma.programming));
  const DataTiming data = dma_.start(transfer);
  if (step_ != nullptr) step_->data = data;
  co_await kernel_.delay(cycles(config_.dma.call));
  if (transfer.background)
    background_.push_back(data.end);
  else
    co_await until_arrived(data.end);
  book_transfer(account, begin);
}

Task<> Cluster::step(const work::TransferWait& wait, CycleAccount& account) {
  const Time begin = kernel_.now();
  co_await until_arrived(background_.at(static_cast<std::size_t>(wait.number)));
  book_transfer(account, begin);
}

void Cluster::book_transfer(CycleAccount& account, Time begin) {
  book(account, fork_in(account, "", accounted()), Mechanism::Transfer,
       accounted() * cycles_since(begin, kernel_.now()));
}

/// A core sleeps on the wait instruction even if the event is there already
/// (FACTS.md#synchronisation).
Task<> Cluster::until_arrived(Time arrival) {
  if (arrival > kernel_.now()) co_await kernel_.at(arrival);
  co_await kernel_.delay(cycles(config_.dma.completion));
}

Task<> Cluster::step(const work::Fork& fork, CycleAccount& account) {
  if (workers_ == 0) {
    co_await run_alone(fork, account);
    co_return;
  }
  const Time begin = kernel_.now();
  ForkAccount* const of_fork = fork_in(account, fork.name, 1);
  arrivals_ = 0;
  const double share = after_fork_ ? config_.events.fork_again : 1;
  const Duration of_master = cycles(share * config_.events.fork_master);
  const Duration of_worker = cycles(share * config_.events.fork_worker);
  co_await kernel_.delay(of_master);
  for (auto& channel : dispatch_)
    co_await channel->push({&fork, &account, of_fork, begin, of_worker});
  if (fork.master_takes_part) {
    const Time share_begin = kernel_.now();
    const MechanismCycles time = co_await team_.execute(workers_, fork.shares.back());
    note(workers_, share_begin, time);
  }
  co_await end_of_fork_.arrive();
  const double last = cycles_since(begin, last_arrival_);
  const double start_up = cycles_since(begin, begin + of_master + of_worker);
  const double after = cycles_since(last_arrival_, kernel_.now());
  const double barrier = std::min(after, config_.events.barrier);
  book(account, of_fork, Mechanism::Imbalance, workers_ * (last + after - barrier) - arrivals_);
  book(account, of_fork, Mechanism::Synchronisation, workers_ * (start_up + barrier));
  if (step_ != nullptr) step_->synchronisation = start_up + barrier;
}

Task<> Cluster::run_alone(const work::Fork& fork, CycleAccount& account) {
  const Time begin = kernel_.now();
  const work::Segment sum = work::shares_on_one_core(fork);
  ForkAccount* const of_fork = fork_in(account, fork.name, 1);
  const MechanismCycles time = co_await team_.execute(workers_, sum, operations_of(of_fork));
  note(workers_, begin, time);
  book(account, of_fork, time);
}

Process Cluster::worker(int id) {
  work::Segment sum;
  for (;;) {
    const Dispatch dispatch = co_await dispatch_[static_cast<std::size_t>(id)]->pop();
    co_await kernel_.delay(dispatch.start_up);
    const Time begin = kernel_.now();
    const MechanismCycles time = co_await team_.execute(id, shares_of(id, *dispatch.fork, sum),
                                                        operations_of(dispatch.of_fork));
    note(id, begin, time);
    book(*dispatch.account, dispatch.of_fork, time);
    last_arrival_ = kernel_.now();
    arrivals_ += cycles_since(dispatch.begin, last_arrival_);
    co_await end_of_fork_.arrive();
  }
}

const work::Segment& Cluster::shares_of(int id, const work::Fork& fork, work::Segment& sum) const {
  const std::size_t shares = fork.shares.size() - (fork.master_takes_part ? 1 : 0);
  const auto first = static_cast<std::size_t>(id);
  const auto step = static_cast<std::size_t>(workers_);
  if (first < shares && first + step >= shares) return fork.shares[first];
  sum = {};
  for (std::size_t k = first; k < shares; k += step) sum += fork.shares[k];
  return sum;
}

}  // namespace leviosim::sim
