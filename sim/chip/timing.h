// What timing a job on a chip yields: for every stage its time, and where the core-cycles of the
// team went. The breakdowns add up: see CycleBreakdown::total(). Who asks for it
// (Cluster::keep_steps) also gets every step with what each core did in it.
#pragma once

#include <string_view>
#include <vector>

#include "sim/chip/cost.h"
#include "sim/events/timebase.h"
#include "sim/work/program.h"

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

/// Where the time of one work segment went, in cycles.
struct SegmentTime {
  UsefulCycles alone;
  double fpu = 0;
  double divider = 0;
  double banks = 0;
  double fetch = 0;
  double accelerator = 0;
  double rounding = 0;

  double waiting() const { return fpu + divider + banks + fetch + accelerator; }
  SegmentTime& operator+=(const SegmentTime& o);
};

/// One work segment on one core.
struct CoreTiming {
  int core = 0;  ///< the master's number is the size of the team
  Time begin;
  Time end;
  SegmentTime time;
};

/// When the data of a transfer flowed.
struct DataTiming {
  Time begin;
  Time end;
};

/// One execution of a step.
struct StepTiming {
  const work::Step* step = nullptr;  ///< of the job
  Time begin;
  Time end;
  double synchronisation = 0;       ///< of a fork: cycles of each worker, as in CycleBreakdown
  std::vector<CoreTiming> cores{};  ///< that worked, in the order in which they ended
  DataTiming data{};                ///< of a transfer
};

/// One execution of a stage. Cycles are of the clock of the cores that ran it.
struct StageTiming {
  std::string_view stage;
  Time begin;
  Time end;
  Cycles cycles;
  CycleBreakdown breakdown;
  std::vector<StepTiming> steps{};  ///< of a cluster that was told to keep them
};

struct JobTiming {
  Time begin;
  Time end;
  std::vector<StageTiming> stages;
};

}  // namespace leviosim::sim
