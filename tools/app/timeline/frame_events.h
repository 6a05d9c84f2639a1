// Events of a run with their times: frames, stages, the steps of a stage, the work of each core in
// a step, transfers, iterations of the optimiser. Plain data, in simulated time: TimelineCollector
// fills it in, writers and pictures read it.
//
// Within a work segment the shares of waiting are known, but not their order (contention.h).
//
// Names are valid as long as the program or, in a replay, as the trace.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "sim/base/units.h"
#include "sim/chip/timing.h"
#include "sim/events/timebase.h"
#include "sim/work/program.h"
#include "tools/app/result/run_result.h"
#include "traces/datasets/frame_range.h"

namespace leviosim::tools {

/// The work of one core in a step. Cycles are of the cluster.
struct CoreEvents {
  int core = 0;  ///< the master's number is the size of the team
  sim::Time begin;
  sim::Time end;
  Cycles worked;               ///< cycles of its work, with waits for shared units
  Cycles idle;                 ///< cycles of a worker from its end to that of the fork
  sim::MechanismCycles split;  ///< breakdown of `worked`; adds up to it
};

/// Data in one direction of the DMA, or of external memory.
struct TransferEvents {
  work::Direction direction = work::Direction::L2ToL1;
  sim::Time begin;  ///< time of its first data
  sim::Time end;
  Bytes bytes;
  int transfers = 1;
  int tiles = 0;  ///< of these: what passes through a memory that has no room for it
};

enum class StepKind : std::uint8_t {
  Serial,    ///< the master works alone
  Fork,      ///< the team works, maybe with the master
  Transfer,  ///< the master programs the DMA, and waits for it unless it goes on in the background
  Wait,      ///< … waits for a transfer in the background
  Several,   ///< steps that were joined (perfetto_timeline.cpp)
};

struct StepEvents {
  StepKind kind = StepKind::Serial;
  std::string_view name;  ///< of a fork
  sim::Time begin;
  sim::Time end;
  Cycles cycles;
  int steps = 1;                  ///< number of steps that were joined
  double synchronisation = 0;     ///< of forks: cycles of starting and of the barrier
  Cycles serial;                  ///< idle cycles of the team while the master works alone
  Cycles transfer;                ///< idle cycles of the team while the master waits for the DMA
  std::vector<CoreEvents> cores;  ///< cores that worked
  std::vector<TransferEvents> transfers;
};

struct StageEvents {
  std::string_view name;
  sim::Time begin;
  sim::Time end;
  Cycles cycles;  ///< of the clock of the cores that ran it
  Bytes memory;   ///< highest occupation of L1, or of L2 by a stage of the controller
  std::optional<Watts> power{};     ///< mean, as EnergyRow::power(); absent without energy figures
  std::vector<StepEvents> steps{};  ///< a controller's: transfers of external memory
};

/// A frame that the front end processed.
struct FrameEvents {
  int frame = 0;  ///< number in the run, from 0
  FrameResult result;
  bool optimisation_begun = false;  ///< its start took the snapshot of an optimisation
  sim::Time work_begin;             ///< of the cluster; cycles are counted from here
  std::vector<StageEvents> stages;
};

/// An iteration of an optimisation, on the controller.
struct IterationEvents {
  int frame = 0;      ///< frame at whose start the snapshot was taken
  int iteration = 0;  ///< number of the iteration, from 0
  bool last = false;  ///< its result was published at the end
  sim::Time begin;
  sim::Time end;
  std::vector<StageEvents> stages;
};

struct TimelineEvents {
  sim::Timebase timebase;
  int cores = 0;                            ///< of the team
  std::optional<traces::FrameRange> range;  ///< of the frames that are kept; all if absent
  std::vector<FrameEvents> frames;
  std::vector<IterationEvents> iterations;

  bool holds(int frame) const {
    const auto number = static_cast<std::size_t>(frame);
    return !range || (number >= range->begin && number < range->end);
  }
};

}  // namespace leviosim::tools
