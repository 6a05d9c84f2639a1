// What timing a job on a chip yields: for every stage its time, and where the core-cycles of the
// team went. The breakdowns add up: see CycleBreakdown::total().
#pragma once

#include <string_view>
#include <vector>

#include "sim/chip/cost.h"
#include "sim/events/timebase.h"

namespace leviosim::sim {

/// Core-cycles of a team during a stage, by what they were spent on. With W workers, a stage of T
/// cycles has W·T of them; what the master does beside them in a fork is not in it.
struct CycleBreakdown {
  UsefulCycles useful;         ///< shares of parallel work, as if each core were alone
  double fpu = 0;              ///< waiting for a shared floating-point unit
  double divider = 0;          ///< waiting for the shared divider
  double banks = 0;            ///< waiting for L1 banks
  double fetch = 0;            ///< waiting for the shared instruction cache that others use too
  double accelerator = 0;      ///< waiting for an accelerator that serves others
  double imbalance = 0;        ///< waiting at the end of a fork for the slowest core
  double synchronisation = 0;  ///< forking, waking up, barriers
  double transfer = 0;         ///< waiting for the DMA
  double serial = 0;           ///< while the master works alone: W times its time
  double rounding = 0;         ///< ends of shares moved to the next clock edge

  double total() const {
    return useful.total() + fpu + divider + banks + fetch + accelerator + imbalance +
           synchronisation + transfer + serial + rounding;
  }
  CycleBreakdown& operator+=(const CycleBreakdown& o);
};

/// One execution of a stage. Cycles are of the clock of the cores that ran it.
struct StageTiming {
  std::string_view stage;
  Time begin;
  Time end;
  Cycles cycles;
  CycleBreakdown breakdown;
};

struct JobTiming {
  Time begin;
  Time end;
  std::vector<StageTiming> stages;
};

}  // namespace leviosim::sim
