// Adds up the stages of all jobs of a run.
#pragma once

#include <string_view>
#include <vector>

#include "sim/chip/timing.h"
#include "sim/soc/stage_totals.h"
#include "sim/work/program.h"

namespace leviosim::soc {

class StageBook {
 public:
  /// With the workload's stages, in its order; stages it did not name are appended as they come.
  /// @param chip  whose accelerators take work from the cores
  StageBook(std::vector<StageResult> stages, const sim::ChipConfig& chip)
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

  const std::vector<StageResult>& stages() const { return stages_; }

 private:
  StageResult& find(std::string_view name);
  void add_segments(const work::StageRun& run, StageResult& stage) const;
  void add_unmeasured(const work::StageRun& run, StageResult& stage) const;
  double unmeasured_cycles(const work::Segment& segment, bool on_controller) const;

  std::vector<StageResult> stages_;
  sim::Accelerators cluster_;
  sim::Accelerators controller_;
  sim::CoreConfig cluster_core_;
  sim::CoreConfig controller_core_;
};

}  // namespace leviosim::soc
