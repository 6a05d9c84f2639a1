// What timing a job on a chip yields: for every stage its time, and the account of where the
// core-cycles of the team went. Who asks for it (Chip::keep_steps) also gets every step with what
// each core did in it.
#pragma once

#include <string_view>
#include <vector>

#include "sim/base/units.h"
#include "sim/chip/account.h"
#include "sim/events/timebase.h"
#include "sim/work/program.h"

namespace leviosim::sim {

/// One work segment on one core.
struct CoreTiming {
  int core = 0;  ///< the master's number is the size of the team
  Time begin;
  Time end;
  MechanismCycles time;  ///< of this core; they add up
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
  double synchronisation = 0;       ///< of a fork: cycles of each worker
  std::vector<CoreTiming> cores{};  ///< that worked, in the order in which they ended
  DataTiming data{};                ///< of a transfer
};

/// One execution of a stage. Cycles are of the clock of the cores that ran it.
struct StageTiming {
  std::string_view stage;
  Time begin;
  Time end;
  Cycles cycles;
  CycleAccount account;
  std::vector<StepTiming> steps{};  ///< if they are kept; a controller's: transfers that take time
};

struct JobTiming {
  Time begin;
  Time end;
  std::vector<StageTiming> stages;
};

}  // namespace leviosim::sim
