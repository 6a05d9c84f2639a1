#include "tests/support/event_cluster.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "sim/chip/accelerator.h"
#include "sim/chip/contention.h"
#include "sim/chip/cost.h"
#include "sim/events/channel.h"
#include "sim/events/kernel.h"
#include "sim/events/last_time.h"
#include "sim/events/sync.h"
#include "sim/events/task.h"
#include "sim/events/timer.h"

namespace leviosim::testing {
namespace {

using namespace leviosim::sim;

/// Cores that run work segments at the same time. The master is the last.
class EventTeam {
 public:
  EventTeam(Kernel& kernel, const ClockDomain& clock, const ClusterConfig& config, int workers)
      : kernel_(kernel),
        clock_(clock),
        config_(config),
        worker_code_(config.icache, config.icache.worker, std::max(1, workers)),
        master_code_(config.icache, config.icache.master, 1),
        contention_(config),
        changed_(kernel, "change of running cores") {
    for (int id = 0; id <= workers; ++id) cores_.push_back(std::make_unique<Core>(kernel));
    kernel_.spawn_server("contention", settle());
  }

  Task<MechanismCycles> execute(int id, const work::Segment& segment) {
    Core& core = *cores_.at(static_cast<std::size_t>(id));
    const bool master = static_cast<std::size_t>(id) + 1 == cores_.size();
    const Demand demand = demand_of(segment, config_.core, config_.accelerators,
                                    master ? master_code_ : worker_code_);
    core.runner = Runner::of(id, demand);
    core.remaining = demand.cycles();
    core.time = {};
    core.progress = {};
    const Time begin = kernel_.now();
    advance();
    core.running = true;
    note_change();
    co_await core.end.expired();
    advance();
    core.running = false;
    note_change();
    const auto elapsed = static_cast<double>(clock_.whole_cycles(kernel_.now() - begin).count());
    core.time[Mechanism::Rounding] = elapsed - demand.cycles() - core.time.waiting();
    core.time += demand.alone;
    co_return core.time;
  }

  /// The DMA moves so many words of L1 per cycle more (or less) from now on.
  void change_traffic(double words_per_cycle) {
    advance();
    dma_words_ += words_per_cycle;
    note_change();
  }

 private:
  struct Core {
    explicit Core(Kernel& kernel) : end(kernel, "end of work") {}
    Timer end;
    bool running = false;
    Runner runner;
    double remaining = 0;
    Progress progress;
    MechanismCycles time;
  };

  Process settle() {
    for (;;) {
      if (!change_noted_) co_await changed_.wait();
      co_await kernel_.delay(Duration(0), Phase::Settle);
      change_noted_ = false;
      solve();
    }
  }
  void note_change() {
    if (change_noted_) return;
    change_noted_ = true;
    changed_.notify();
  }
  void advance() {
    const auto cycles =
        static_cast<double>(clock_.whole_cycles(kernel_.now() - advanced_to_).count());
    advanced_to_ = kernel_.now();
    if (cycles == 0) return;
    for (const auto& core : cores_) {
      if (!core->running) continue;
      const double worked = std::min(cycles, core->remaining / core->progress.rate);
      core->remaining -= worked * core->progress.rate;
      core->time.add(core->progress.lost, worked);
    }
  }
  void solve() {
    advance();
    std::vector<Runner> runners;
    for (const auto& core : cores_)
      if (core->running) runners.push_back(core->runner);
    std::vector<Progress> progress;
    contention_.solve(runners, progress, dma_words_);
    for (std::size_t i = 0; i < runners.size(); ++i) {
      Core& core = *cores_[static_cast<std::size_t>(runners[i].core)];
      core.progress = progress[i];
      const double left = std::ceil(core.remaining / core.progress.rate - 1e-6);
      core.end.arm(kernel_.now() + clock_.duration(counted_cycles(std::max(left, 0.0))));
    }
  }

  Kernel& kernel_;
  const ClockDomain& clock_;
  ClusterConfig config_;
  CodeFetcher worker_code_;
  CodeFetcher master_code_;
  Contention contention_;
  std::vector<std::unique_ptr<Core>> cores_;
  Event changed_;
  bool change_noted_ = false;
  double dma_words_ = 0;
  Time advanced_to_;
};

class EventCluster {
 public:
  EventCluster(Kernel& kernel, const ClockDomain& clock, const ClusterConfig& config, int workers)
      : kernel_(kernel),
        clock_(clock),
        config_(config),
        workers_(workers),
        team_(kernel, clock, config, workers),
        end_of_fork_(kernel, "end of fork", static_cast<std::size_t>(workers) + 1,
                     cycles(config.events.barrier)) {
    for (int id = 0; id < workers_; ++id) {
      dispatch_.push_back(std::make_unique<Channel<Dispatch>>(kernel_, "dispatch", 1));
      kernel_.spawn_server(fmt::format("core {}", id), worker(id));
    }
  }

  Process run(const work::Job& job, JobTiming& timing) {
    for (const work::StageRun& stage : job.stages) {
      StageTiming s{stage.stage, kernel_.now(), {}, {}, {}};
      for (const work::Step& variant : stage.steps) {
        if (const auto* serial = std::get_if<work::Serial>(&variant))
          co_await step(*serial, s.account.team);
        else if (const auto* fork = std::get_if<work::Fork>(&variant))
          co_await step(*fork, s.account.team);
        else if (const auto* transfer = std::get_if<work::Transfer>(&variant))
          co_await step(*transfer, s.account.team);
        else
          co_await step(std::get<work::TransferWait>(variant), s.account.team);
        after_fork_ = std::holds_alternative<work::Fork>(variant);
      }
      s.end = kernel_.now();
      s.cycles = clock_.whole_cycles(s.end - s.begin);
      timing.stages.push_back(std::move(s));
    }
    timing.end = kernel_.now();
  }

 private:
  struct Dispatch {
    const work::Fork* fork;
    MechanismCycles* account;
    Time begin;
    Duration start_up;
  };

  Duration cycles(double n) const { return clock_.duration(counted_cycles(std::round(n))); }
  double cycles_since(Time begin, Time end) const {
    return static_cast<double>(clock_.whole_cycles(end - begin).count());
  }

  Task<> step(const work::Serial& serial, MechanismCycles& account) {
    const Time begin = kernel_.now();
    co_await team_.execute(workers_, serial.counts);
    account[Mechanism::Serial] += workers_ * cycles_since(begin, kernel_.now());
  }

  Task<> step(const work::Fork& fork, MechanismCycles& account) {
    const Time begin = kernel_.now();
    arrivals_ = 0;
    const double part = after_fork_ ? config_.events.fork_again : 1;
    const Duration of_master = cycles(part * config_.events.fork_master);
    const Duration of_worker = cycles(part * config_.events.fork_worker);
    co_await kernel_.delay(of_master);
    for (auto& channel : dispatch_) co_await channel->push({&fork, &account, begin, of_worker});
    if (fork.master_takes_part) co_await team_.execute(workers_, fork.shares.back());
    co_await end_of_fork_.arrive();
    const double last = cycles_since(begin, last_arrival_);
    const double start_up = cycles_since(begin, begin + of_master + of_worker);
    const double after = cycles_since(last_arrival_, kernel_.now());
    const double barrier = std::min(after, config_.events.barrier);
    account[Mechanism::Imbalance] += workers_ * (last + after - barrier) - arrivals_;
    account[Mechanism::Synchronisation] += workers_ * (start_up + barrier);
  }

  Process worker(int id) {
    for (;;) {
      const Dispatch dispatch = co_await dispatch_[static_cast<std::size_t>(id)]->pop();
      co_await kernel_.delay(dispatch.start_up);
      work::Segment mine;
      const std::size_t shares =
          dispatch.fork->shares.size() - (dispatch.fork->master_takes_part ? 1 : 0);
      for (auto k = static_cast<std::size_t>(id); k < shares;
           k += static_cast<std::size_t>(workers_))
        mine += dispatch.fork->shares[k];
      *dispatch.account += co_await team_.execute(id, mine);
      last_arrival_ = kernel_.now();
      arrivals_ += cycles_since(dispatch.begin, last_arrival_);
      co_await end_of_fork_.arrive();
    }
  }

  Task<> step(const work::Transfer& transfer, MechanismCycles& account) {
    const Time begin = kernel_.now();
    std::erase_if(under_way_, [&](Time end) { return end <= begin; });
    if (!under_way_.empty() && under_way_.size() >= static_cast<std::size_t>(config_.dma.commands))
      co_await kernel_.at(*std::min_element(under_way_.begin(), under_way_.end()));
    co_await kernel_.delay(cycles(config_.dma.programming));
    Time& free = free_[transfer.direction == work::Direction::L2ToL1 ? 0 : 1];
    const Time first = std::max(free, kernel_.now() + cycles(config_.dma.first_data));
    const auto bytes = static_cast<double>(transfer.bytes.count());
    free = first + cycles(std::ceil(bytes / config_.dma.bytes_per_cycle));
    const Time last = free;
    if (config_.dma.commands > 0) under_way_.push_back(last);
    if (transfer.background) kernel_.spawn("DMA data", disturb(first, last));
    co_await kernel_.delay(cycles(config_.dma.call));
    if (transfer.background)
      background_.push_back(last);
    else
      co_await until_arrived(last);
    account[Mechanism::Transfer] += workers_ * cycles_since(begin, kernel_.now());
  }

  Task<> step(const work::TransferWait& wait, MechanismCycles& account) {
    const Time begin = kernel_.now();
    co_await until_arrived(background_.at(static_cast<std::size_t>(wait.number)));
    account[Mechanism::Transfer] += workers_ * cycles_since(begin, kernel_.now());
  }

  Task<> until_arrived(Time arrival) {
    if (arrival > kernel_.now()) co_await kernel_.at(arrival);
    co_await kernel_.delay(cycles(config_.dma.completion));
  }

  Process disturb(Time begin, Time end) {
    const double words = config_.dma.bytes_per_cycle / 4;
    co_await kernel_.at(begin);
    team_.change_traffic(words);
    co_await kernel_.at(end);
    team_.change_traffic(-words);
  }

  Kernel& kernel_;
  const ClockDomain& clock_;
  ClusterConfig config_;
  int workers_;
  EventTeam team_;
  Barrier end_of_fork_;
  std::vector<std::unique_ptr<Channel<Dispatch>>> dispatch_;
  std::array<Time, 2> free_{};
  std::vector<Time> under_way_;
  std::vector<Time> background_;
  bool after_fork_ = false;
  Time last_arrival_;
  double arrivals_ = 0;
};

}  // namespace

sim::JobTiming time_in_event_kernel(const sim::ClusterConfig& config, int workers,
                                    const work::Job& job) {
  const Timebase timebase({{"cluster", config.clock}});
  Kernel kernel;
  EventCluster cluster(kernel, timebase.clock("cluster"), config, workers);
  sim::JobTiming timing;
  kernel.spawn("job", cluster.run(job, timing));
  kernel.run();
  return timing;
}

}  // namespace leviosim::testing
