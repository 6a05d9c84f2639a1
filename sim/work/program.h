// What a workload did, as the chip sees it: the recorded form of the work vocabulary. A Job is what
// one processor runs in one go (the front end for one frame, the optimiser for one iteration); it
// is a list of stages, each a list of steps executed one after the other by the job's master core.
//
// The chip times a Job as soon as the workload has recorded it, and a stored Job is timed in the
// same way, so live runs and replays have one timing path.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sim/base/units.h"
#include "sim/work/offload_regions.h"

namespace leviosim::work {

/// Work of the master core alone.
struct Serial {
  Segment counts;
};

/// The master offloads one share of work to each worker and waits for all of them.
struct Fork {
  std::string_view name;
  std::vector<Segment> shares;     ///< one per worker, in the order of their ids
  bool master_takes_part = false;  ///< then the last share is the master's own
  /// The program of one core has another order of allocations, in which no word straddles.
  bool aligned_on_one_core = false;
};

/// The shares of a fork together, as one core executes them alone. Its scratch begins where that of
/// the first core of a team does, so words straddle as often as in the first share, unless the
/// program of one core aligns them.
Segment shares_on_one_core(const Fork& fork);

/// External memory is reached from L2 only, by the controller.
enum class Direction : std::uint8_t { L2ToL1, L1ToL2, ExternalToL2, L2ToExternal };

constexpr bool is_between_l1_and_l2(Direction direction) {
  return direction == Direction::L2ToL1 || direction == Direction::L1ToL2;
}

/// One transfer, programmed by the master core, which waits for it unless it goes on in the
/// background.
struct Transfer {
  Direction direction;
  Bytes bytes;
  bool background = false;
  Bytes more{0};  ///< of these, what would not move if the block stayed in local memory
};

/// The master waits for a background transfer of the same job: number 0 is the first.
struct TransferWait {
  std::int32_t number;
};

using Step = std::variant<Serial, Fork, Transfer, TransferWait>;

/// A live allocation in a memory. `name` must outlive its arena: a string literal.
struct Block {
  std::string_view name;
  Bytes offset;
  Bytes size;
};

/// A block that passed through the local memory in tiles, in all calls of a stage.
struct Passage {
  std::string_view stage, block;
  std::int64_t tiles = 0;
  Bytes bytes{0};
};

/// Highest occupation of a memory during a stage.
struct MemoryPeak {
  Bytes parallel;             ///< with the scratch of all cores alive at once
  Bytes single;               ///< with the scratch of one core, as one core alone would need
  std::vector<Block> blocks;  ///< alive at the parallel peak
};

struct StageRun {
  std::string_view stage;
  std::vector<Step> steps;
  MemoryPeak memory;  ///< of the machine's own memory (L1 for the cluster, L2 for the controller)
};

/// All operations of a stage, whoever executed them.
inline Counts counts_of(const StageRun& stage) {
  Counts sum;
  for (const Step& step : stage.steps) {
    if (const auto* serial = std::get_if<Serial>(&step)) sum += serial->counts;
    if (const auto* fork = std::get_if<Fork>(&step))
      for (const Segment& share : fork->shares) sum += static_cast<const Counts&>(share);
  }
  return sum;
}

/// The counts of a step with what of them was done in offload regions.
inline Segment segments_of(const StageRun& stage) {
  Segment sum;
  for (const Step& step : stage.steps) {
    if (const auto* serial = std::get_if<Serial>(&step)) sum += serial->counts;
    if (const auto* fork = std::get_if<Fork>(&step))
      for (const Segment& share : fork->shares) sum += share;
  }
  return sum;
}

struct Job {
  std::vector<StageRun> stages;
};

}  // namespace leviosim::work
