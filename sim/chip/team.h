// Cores of a cluster that run work segments at the same time and share units.
//
// Whenever a core starts or ends a work segment, the rates of all running ones are solved again
// (contention.h), once per instant, and their ends are moved. No cycle is stepped.
#pragma once

#include <memory>
#include <vector>

#include "sim/chip/accelerator.h"
#include "sim/chip/contention.h"
#include "sim/chip/cost.h"
#include "sim/chip/timing.h"
#include "sim/events/kernel.h"
#include "sim/events/sync.h"
#include "sim/events/task.h"

namespace leviosim::sim {

class Team {
 public:
  /// @param workers  ids 0 … workers-1; the master is core `workers`
  Team(Kernel& kernel, const ClockDomain& clock, const ClusterConfig& config, int workers);

  /// co_await: core `id` runs the work segment; at most one per core at a time.
  /// @param by_operation  gets what of it each kind of operation has; may be null
  /// @returns what the core's cycles were spent on; they add up to the cycles it took
  Task<MechanismCycles> execute(int id, const work::Segment& segment,
                                OperationAccounts* by_operation = nullptr);

  /// The DMA moves so many words of L1 per cycle more (or less) from now on.
  void change_traffic(double words_per_cycle);

 private:
  struct Core {
    explicit Core(Kernel& kernel, int id);
    Timer end;
    bool running = false;
    Demand demand;
    Runner runner;         ///< the segment as the contention solver sees it
    double remaining = 0;  ///< lone cycles still to do
    Progress progress;
    MechanismCycles time;
  };

  Process settle();
  void note_change();
  void advance();
  void solve();

  Kernel& kernel_;
  const ClockDomain& clock_;
  CoreConfig core_config_;
  Accelerators accelerators_;
  CodeFetcher worker_code_;
  CodeFetcher master_code_;
  Contention contention_;
  std::vector<std::unique_ptr<Core>> cores_;
  std::vector<Runner> runners_;
  std::vector<Progress> progress_;
  Event changed_;
  bool change_noted_ = false;
  double dma_words_ = 0;
  Time advanced_to_;
};

}  // namespace leviosim::sim
