// The numbers that describe a chip: what a platform file (platform_models/) fills in. Every
// number's source stands beside it in the platform file; the comments here say what it means.
//
// Cycles are cycles of the clock domain that the structure belongs to; what the cluster awaits from
// L2 (loads, DMA, refills of instruction caches) belongs to the SoC, whose clock is the
// controller's. They are real numbers where the value is an average over many events.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>

#include "sim/base/units.h"
#include "sim/chip/area_config.h"
#include "sim/chip/energy_config.h"
#include "sim/work/compiled_work.h"
#include "sim/work/counts.h"
#include "sim/work/offload_regions.h"

namespace leviosim::sim {

/// Which unit an operation occupies besides its core.
enum class Unit : std::uint8_t {
  Core,
  Fpu,
  Divider,
  Int64,
  Bank,    ///< the one bank of L1 that holds a word which all cores use
  L1,      ///< all banks of L1 together; no operation's, but accesses'
  Refill,  ///< of the shared instruction cache from L2; no operation's, but code's
  /// Accelerators follow, one for each kind of kernel; no operation's, but calls'.
};
inline constexpr std::size_t kFirstAccelerator = 7;
inline constexpr std::size_t kUnitCount = kFirstAccelerator + work::kOffloadKindCount;
constexpr Unit accelerator_of(work::OffloadKind kind) {
  return static_cast<Unit>(kFirstAccelerator + work::index(kind));
}

/// What one counted operation costs a core that is alone.
struct OpCost {
  double issue = 0;  ///< instructions issued
  double stall = 0;  ///< cycles the pipeline waits in addition
  Unit unit = Unit::Core;
  double busy = 1;       ///< cycles that it occupies the unit, if that is not the core
  bool routine = false;  ///< the numbers are of a whole library routine as it was compiled

  friend bool operator==(const OpCost&, const OpCost&) = default;
};

/// What operations cost that files leave out: those that are older than the operation.
std::array<OpCost, work::kOpCount> default_costs();

/// How counted operations become instructions of one instruction set, and their latencies.
struct CoreConfig {
  std::array<OpCost, work::kOpCount> ops = default_costs();
  /// Instructions executed per one that ops account for, routines left out, in code that was not
  /// measured. That of measured functions has a ratio of its own (work::CompiledWork).
  double unmeasured_instructions = 1;
  /// Instructions that another compiler makes of measured code, per one of the compiler that it was
  /// measured with. 1 on every chip: bands ask what other values would change.
  double measured_instructions = 1;
  /// Share of loads whose result the next instruction uses, in code that was not measured.
  double load_use_fraction = 0;
  double load_use_stall = 0;                             ///< cycles such a load waits
  work::CompiledFor code = work::CompiledFor::Rv32imfc;  ///< whose measured code it executes

  const OpCost& operator[](work::Op op) const { return ops[work::index(op)]; }
  friend bool operator==(const CoreConfig&, const CoreConfig&) = default;
};

/// Arithmetic units shared by the cores of a cluster. How long an operation occupies its unit is
/// said with the operation (OpCost::busy).
enum class FpuMapping : std::uint8_t {
  Fixed,   ///< core c uses unit c mod n
  Dynamic  ///< any core uses any free unit
};

struct FpuConfig {
  int units = 0;
  FpuMapping mapping = FpuMapping::Fixed;
  int dividers = 0;       ///< divide/square-root units of the cluster, any core uses any
  int int64_units = 0;    ///< units for 64-bit integers, mapped as the floating-point ones
  double collisions = 0;  ///< chance collisions at a unit, over those of cores at any phase; 0:
                          ///< cores find their turns

  friend bool operator==(const FpuConfig&, const FpuConfig&) = default;
};

/// Instruction caches of a group of cores, with L2 behind them (instruction_cache.h).
struct InstructionCacheConfig {
  Bytes line;              ///< bytes fetched at once; 0: fetching code costs nothing
  Bytes worker;            ///< private cache of a worker (or of the controller); 0: none
  Bytes master;            ///< private cache of the cluster's master
  Bytes shared;            ///< cache that the cores share; 0: none
  int shared_banks = 1;    ///< lines that the shared cache can deliver in a cycle
  double shared_hit = 0;   ///< cycles waited for a line that the private cache lacks
  double shared_miss = 0;  ///< cycles waited until a line begins to come from L2
  double refills = 1;      ///< lines that the shared cache can await from L2 at once
  /// Bytes of a line that come per cycle, once it comes.
  double refill_width = std::numeric_limits<double>::infinity();
  int ways = 4;          ///< lines of a set, in all caches
  double code_size = 1;  ///< bytes of code for each one that was measured
  /// Measured bytes of the cores' code for each byte of work::Counts::code. Follows from
  /// CoreConfig::code.
  double measured_size = 1;

  /// Cycles until the whole of a line that has to come from L2 is there.
  double refill() const { return shared_miss + static_cast<double>(line.count()) / refill_width; }

  friend bool operator==(const InstructionCacheConfig&, const InstructionCacheConfig&) = default;
};

struct L1Config {
  Bytes size;
  int banks = 1;
  double stream_conflicts = 0;  ///< of the streams of several cores, over those of as many
                                ///< scattered accesses; 0: streams walk in step
};

/// Hardware that serves the calls of one kind of kernel (accelerator.h).
struct AcceleratorConfig {
  int units = 0;               ///< 0: there is none
  double start_up = 0;         ///< instructions of the calling core per call
  double latency = 0;          ///< cycles of a call besides those of its items
  double items_per_cycle = 1;  ///< of each unit
  double l1_words = 0;         ///< words of L1 that a unit moves per cycle while it works

  friend bool operator==(const AcceleratorConfig&, const AcceleratorConfig&) = default;
};
using Accelerators = std::array<AcceleratorConfig, work::kOffloadKindCount>;

struct DmaConfig {
  double programming = 0;      ///< cycles of the programming core until the transfer begins
  double first_data = 0;       ///< latency until the first beat arrives
  double bytes_per_cycle = 0;  ///< payload
  double completion = 0;       ///< from the last beat until the waiting core goes on
  int commands = 0;            ///< transfers that are under way at most; 0: any number
  double call = 0;             ///< cycles of the programming core once the transfer has begun: the
                               ///< rest of the call of the API, while data may flow
};

struct EventUnitConfig {
  double fork_master = 0;  ///< master: masks, dispatch of entry and argument
  double fork_worker = 0;  ///< worker: wake-up, fetch of entry and argument, jump
  double barrier = 0;      ///< from the last arrival until everyone goes on
  double offload = 0;      ///< controller → cluster task, one way, in cycles of the controller
  double fork_again = 1;   ///< share of the fork's cycles that one takes right after another
};

struct ClusterConfig {
  Hertz clock;
  int workers = 0;
  int max_workers = 0;  ///< what the event unit can serve
  CoreConfig core;
  FpuConfig fpu;
  InstructionCacheConfig icache;
  L1Config l1;
  DmaConfig dma;
  EventUnitConfig events;
  Accelerators accelerators{};
};

/// Memory outside of the chip, which the controller copies from and to L2
/// (FACTS.md#external-memory). A transfer takes `latency` and the time of its bytes, of which at
/// least `burst` move.
struct ExternalMemoryConfig {
  double latency_seconds = 0;
  double bytes_per_second = 0;  ///< 0: there is none
  Bytes burst{0};
  Bytes size{0};
};

/// The fabric controller: one core with its own floating-point unit; its memory is L2.
struct ControllerConfig {
  Hertz clock;
  CoreConfig core;
  InstructionCacheConfig icache;
  ExternalMemoryConfig external{};
  bool shares_core = false;  ///< a chip with one core: its work and the cluster's take turns
  Accelerators accelerators{};
};

struct L2Config {
  Bytes size;
};

struct ChipConfig {
  std::string name;
  ClusterConfig cluster;
  ControllerConfig controller;
  L2Config l2;
  SupplyConfig supply{};
  EnergyRange energy{};
  AreaRange area{};
};

/// The compiled code that all cores execute; none if they differ.
inline std::optional<work::CompiledFor> code_of(const ChipConfig& chip) {
  if (chip.cluster.core.code != chip.controller.core.code) return {};
  return chip.cluster.core.code;
}

}  // namespace leviosim::sim
