// The fabric controller: one core with its own floating-point unit, working in L2. It runs jobs of
// serial work; it shares nothing that this workload contends for.
#pragma once

#include <vector>

#include "sim/chip/config.h"
#include "sim/chip/cost.h"
#include "sim/chip/instruction_cache.h"
#include "sim/chip/timing.h"
#include "sim/events/kernel.h"
#include "sim/events/task.h"
#include "sim/work/program.h"

namespace leviosim::sim {

class Controller {
 public:
  Controller(Kernel& kernel, const ClockDomain& clock, const ControllerConfig& config)
      : kernel_(kernel),
        clock_(clock),
        config_(config),
        costs_(config.core),
        code_(config.icache, config.icache.worker, 1) {}

  /// Runs the job, which begins at that time. Forks run their shares one after the other; transfers
  /// copy nothing, since the controller works where the data lies, except for those from and to
  /// external memory: the controller is busy for their latency; their data pass one after the
  /// other, in the background while it works on.
  JobTiming time(const work::Job& job, Time begin) const;
  /// co_await: the same from now on, until it is done.
  Task<JobTiming> run(const work::Job& job);

  /// As of Cluster; of steps, those that move data from or to external memory.
  void keep_steps(bool keep) { keep_steps_ = keep; }
  void keep_forks(bool keep) { keep_forks_ = keep; }

  const ClockDomain& clock() const { return clock_; }

 private:
  /// What is under way within a job, in cycles since its begin.
  struct ExternalTransfers {
    Time begin;  ///< of the job
    double now = 0;
    double free = 0;           ///< from when on the next data may pass
    std::vector<double> done;  ///< by number of the background transfer
  };

  Demand demand_of_stage(const work::StageRun& stage, OperationAccounts* by_operation) const;
  void book(StageTiming& stage, const work::StageRun& run, ExternalTransfers& transfers) const;
  double wait_for_transfers(const work::StageRun& run, double work, StageTiming& stage,
                            ExternalTransfers& transfers) const;
  /// When the data of a transfer have passed that is programmed now.
  double pass(const work::Step& step, StageTiming& stage, double& waited,
              ExternalTransfers& transfers) const;

  Kernel& kernel_;
  const ClockDomain& clock_;
  ControllerConfig config_;
  CoreCosts costs_;
  CodeFetcher code_;
  bool keep_steps_ = false;
  bool keep_forks_ = false;
};

}  // namespace leviosim::sim
