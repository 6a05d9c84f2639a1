#include "sim/chip/team.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/check.h"
#include "sim/events/timebase.h"

namespace leviosim::sim {
namespace {

// Rates are quotients: what is left at the end of a work segment may miss zero by rounding.
constexpr double kNothingLeft = 1e-6;

}  // namespace

Team::Core::Core(Kernel& kernel, int id) : end(kernel, fmt::format("end of work on core {}", id)) {}

Team::Team(Kernel& kernel, const ClockDomain& clock, const ClusterConfig& config, int workers)
    : kernel_(kernel),
      clock_(clock),
      core_config_(config.core),
      accelerators_(config.accelerators),
      worker_code_(config.icache, config.icache.worker, std::max(1, workers)),
      master_code_(config.icache, config.icache.master, 1),
      contention_(config),
      changed_(kernel, "change of running cores") {
  for (int id = 0; id <= workers; ++id) cores_.push_back(std::make_unique<Core>(kernel, id));
  kernel_.spawn_server("contention", settle());
}

Task<MechanismCycles> Team::execute(int id, const work::Segment& segment,
                                    OperationAccounts* by_operation) {
  Core& core = *cores_.at(static_cast<std::size_t>(id));
  check(!core.running, "a core runs one work segment at a time");
  const bool master = static_cast<std::size_t>(id) + 1 == cores_.size();
  core.demand = demand_of(segment, core_config_, accelerators_,
                          master ? master_code_ : worker_code_, by_operation);
  core.runner = Runner::of(id, core.demand);
  core.remaining = core.demand.cycles();
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
  core.time[Mechanism::Rounding] = elapsed - core.demand.cycles() - core.time.waiting();
  core.time += core.demand.alone;
  co_return core.time;
}

void Team::change_traffic(double words_per_cycle) {
  advance();
  dma_words_ += words_per_cycle;
  note_change();
}

void Team::note_change() {
  if (change_noted_) return;
  change_noted_ = true;
  changed_.notify();
}

Process Team::settle() {
  for (;;) {
    if (!change_noted_) co_await changed_.wait();
    co_await kernel_.delay(Duration(0), Phase::Settle);
    change_noted_ = false;
    solve();
  }
}

/// Books the time since the last change at the rates that were valid then.
void Team::advance() {
  const auto cycles =
      static_cast<double>(clock_.whole_cycles(kernel_.now() - advanced_to_).count());
  advanced_to_ = kernel_.now();
  if (cycles == 0) return;
  for (const auto& core : cores_) {
    if (!core->running) continue;
    // The last, partial cycle of a work segment is not lost to anybody: it is rounding.
    const double worked = std::min(cycles, core->remaining / core->progress.rate);
    core->remaining -= worked * core->progress.rate;
    core->time.add(core->progress.lost, worked);
  }
}

void Team::solve() {
  advance();
  runners_.clear();
  for (const auto& core : cores_)
    if (core->running) runners_.push_back(core->runner);
  contention_.solve(runners_, progress_, dma_words_);
  for (std::size_t i = 0; i < runners_.size(); ++i) {
    Core& core = *cores_[static_cast<std::size_t>(runners_[i].core)];
    core.progress = progress_[i];
    const double left = std::ceil(core.remaining / core.progress.rate - kNothingLeft);
    core.end.arm(kernel_.now() + clock_.duration(counted_cycles(std::max(left, 0.0))));
  }
}

}  // namespace leviosim::sim
