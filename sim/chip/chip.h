// A chip: its clocks, a cluster and a fabric controller on one event kernel.
#pragma once

#include <memory>
#include <optional>

#include "sim/chip/cluster.h"
#include "sim/chip/controller.h"
#include "sim/events/sync.h"

namespace leviosim::sim {

/// Exact time over the clocks of a chip. @throws InputError for clocks without a common tick
Timebase timebase_of(const ChipConfig& config);

class Chip {
 public:
  /// @param workers  size of the cluster's team
  /// @throws InputError for clocks without a common tick or more workers than the event unit serves
  Chip(const ChipConfig& config, int workers);

  Kernel& kernel() { return kernel_; }
  const Kernel& kernel() const { return kernel_; }
  const Timebase& timebase() const { return timebase_; }
  Cluster& cluster() { return cluster_; }
  Controller& controller() { return controller_; }
  /// Whether timings hold the steps of each stage (timing.h).
  void keep_steps(bool keep) {
    cluster_.keep_steps(keep);
    controller_.keep_steps(keep);
  }
  /// Whether accounts of jobs are by fork and kind of operation, too.
  void keep_forks(bool keep) {
    cluster_.keep_forks(keep);
    controller_.keep_forks(keep);
  }

  /// co_await: the controller sends the job to the cluster and hears when it is done.
  /// @param known  cycles of the cluster that it takes; then it is not timed, and without stages
  Task<JobTiming> offload(const work::Job& job, std::optional<Cycles> known = {});
  /// co_await: the controller runs the job itself. @param known  the same, of the controller
  Task<JobTiming> control(const work::Job& job, std::optional<Cycles> known = {});
  /// The same of a chip that has nothing else to do.
  JobTiming time_offload(const work::Job& job, Time begin = {}, std::optional<Cycles> known = {});
  JobTiming time_control(const work::Job& job) const { return controller_.time(job, {}); }

 private:
  /// co_await: whoever works next has a core; where there is one only, first come first served. A
  /// job is not interrupted.
  Task<> take_core();
  void leave_core();

  ChipConfig config_;
  Timebase timebase_;
  Kernel kernel_;
  Cluster cluster_;
  Controller controller_;
  Semaphore core_;  ///< the one of a chip with one core
};

}  // namespace leviosim::sim
