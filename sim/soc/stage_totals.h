// One stage of a workload over a whole run: how often it ran, how long, on what, and in how much
// memory. Plain data: StageBook adds it up.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/base/units.h"
#include "sim/chip/timing.h"
#include "sim/work/program.h"
#include "sim/work/transfers.h"

namespace leviosim::soc {

struct StageResult {
  std::string name;
  std::string unit = "call";   ///< what one call is: "frame", "sample", "iteration", …
  bool on_controller = false;  ///< runs on the fabric controller, one core whatever N is
  std::int64_t calls = 0;
  Cycles single;                       ///< one core, summed over the calls
  Cycles parallel;                     ///< N cores, summed over the calls
  Cycles worst_parallel;               ///< longest call on N cores
  sim::CycleBreakdown breakdown;       ///< of the N-core execution, core-cycles
  sim::CycleBreakdown single_account;  ///< of the execution on one core
  work::Counts counts;                 ///< operations executed by cores
  double unmeasured = 0;  ///< core-cycles of work segments of which no compiled code was measured
  std::vector<work::OffloadWork> served;  ///< calls that accelerators served
  work::MemoryPeak memory;  ///< highest peak over the calls, of L1 (L2 for the controller)
  std::vector<work::Block> persistent;  ///< filled in for the controller's L2 only
  work::Transferred transfers;          ///< between L1 and L2
};

}  // namespace leviosim::soc
