// What a stage would take on one core of a chip whose code-generation constants were others, from
// one recorded run: its operations are costed again, without running anything.
//
// On one core nothing contends, so its time is the sum of what its operations cost alone
// (sim/chip/cost.h), and of code fetches, forks, barriers, transfers and rounding, which do not
// depend on these constants. The latter is what the recorded time exceeds the cost of the
// operations on the chip of the run by.
#pragma once

#include <string>
#include <vector>

#include "sim/chip/config.h"
#include "sim/chip/work_sum.h"
#include "tools/app/validation/paper_stages.h"

namespace leviosim::tools {

struct StageModel {
  std::string key;
  std::string title;
  std::int64_t frames = 0;
  sim::WorkSum work;     ///< of the frames
  double fixed = 0;      ///< cycles beside the operations, summed over the frames
  double reference = 0;  ///< cycles of a mean call that the fit aims at

  /// Cycles of a mean call on one core.
  double cycles(const sim::ChipConfig& chip) const;
};

/// The six stages of the paper's table from a run on `chip`; aims are the paper's one-core values.
/// @throws InputError if the run has no frame of a stage
std::vector<StageModel> stage_models(const FrameLog& log, const sim::ChipConfig& chip);

}  // namespace leviosim::tools
