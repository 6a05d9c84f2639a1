// Times jobs one by one on a chip of its own, in a time of its own: what one core of the chip would
// need beside the run on all, and what recorded jobs take on another chip. No camera and no queue:
// a job does not wait for the one before.
#pragma once

#include "sim/chip/chip.h"
#include "sim/work/program.h"

namespace leviosim::soc {

class JobTimer {
 public:
  /// @param workers  as of sim::Cluster
  /// @throws InputError as sim::Chip
  JobTimer(const sim::ChipConfig& config, int workers) : chip_(config, workers) {}

  /// As of sim::Team.
  void remember(sim::TeamMemory* memory) { chip_.cluster().remember(memory); }
  void recall(const sim::TeamMemory* memory) { chip_.cluster().recall(memory); }
  /// Of the cluster as it is timed, in its own cycles.
  const sim::ClusterConfig& cluster() { return chip_.cluster().config(); }

  /// A job of the front end: offloaded by the controller, run by the cluster.
  sim::JobTiming front_end(const work::Job& job) { return chip_.time_offload(job); }
  /// A job of the optimiser, on the controller.
  sim::JobTiming optimiser(const work::Job& job) { return chip_.time_control(job); }

  /// Whole cycles of the cluster from the controller's call until it is notified of the end.
  Cycles front_end_cycles(const sim::JobTiming& timing) {
    return chip_.cluster().clock().whole_cycles(timing.end - timing.begin);
  }

 private:
  sim::Chip chip_;
};

}  // namespace leviosim::soc
