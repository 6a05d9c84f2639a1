// The account of a run: each stage of a workload over all jobs, how often it ran, how long, on
// what, in how much memory, and where its cycles went (sim/chip/account.h).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/units.h"
#include "sim/chip/config.h"
#include "sim/chip/cost.h"
#include "sim/chip/timing.h"
#include "sim/work/program.h"
#include "sim/work/transfers.h"

namespace leviosim::soc {

struct StageResult {
  std::string name;
  std::string unit = "call";   ///< what one call is: "frame", "sample", "iteration", …
  bool on_controller = false;  ///< runs on the fabric controller, one core whatever N is
  std::int64_t calls = 0;
  Cycles single;                        ///< one core, summed over the calls
  Cycles parallel;                      ///< N cores, summed over the calls
  Cycles worst_parallel;                ///< longest call on N cores
  sim::CycleAccount account;            ///< of the N-core execution, by fork and operation
  sim::MechanismCycles single_account;  ///< of the execution on one core
  work::Counts counts;                  ///< operations executed by cores
  double unmeasured = 0;  ///< core-cycles of work segments of which no compiled code was measured
  std::vector<work::OffloadWork> served;  ///< calls that accelerators served
  work::MemoryPeak memory;  ///< highest peak over the calls, of L1 (L2 for the controller)
  std::vector<work::Block> persistent;  ///< filled in for the controller's L2 only
  work::Transferred transfers;          ///< between L1 and L2
};

/// Adds up the stages of all jobs of a run.
class RunAccount {
 public:
  /// With the workload's stages, in its order; stages it did not name are appended as they come.
  /// @param chip  whose accelerators take work from the cores
  RunAccount(std::vector<StageResult> stages, const sim::ChipConfig& chip)
      : stages_(std::move(stages)),
        cluster_(chip.cluster.accelerators),
        controller_(chip.controller.accelerators),
        cluster_core_(chip.cluster.core),
        controller_core_(chip.controller.core) {}

  /// What a job executed and occupied.
  void add_work(const work::Job& job);
  /// How long it took on the chip, and on one core of it.
  void add_parallel(const sim::JobTiming& timing);
  void add_single(const sim::JobTiming& timing);

  /// A job of the front end took so many cycles, those of its stages among them.
  void add_offload(Cycles whole, const sim::JobTiming& timing);

  const std::vector<StageResult>& stages() const { return stages_; }
  /// What the cluster's jobs took that no stage did (sim::Mechanism::Offload).
  Cycles offload() const { return offload_; }

 private:
  StageResult& find(std::string_view name);
  void add_segments(const work::StageRun& run, StageResult& stage) const;
  void add_unmeasured(const work::StageRun& run, StageResult& stage) const;
  double unmeasured_cycles(const work::Segment& segment, bool on_controller) const;

  std::vector<StageResult> stages_;
  Cycles offload_;
  sim::Accelerators cluster_;
  sim::Accelerators controller_;
  sim::CoreCosts cluster_core_;
  sim::CoreCosts controller_core_;
};

}  // namespace leviosim::soc
