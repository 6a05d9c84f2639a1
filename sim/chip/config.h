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
#include "sim/work/compiled_work.h"
#include "sim/work/counts.h"
#include "sim/work/offload_regions.h"

namespace leviosim::sim {

// The numbers behind energy: what events cost, what flows without events, and which clocks a supply
// voltage allows. Filled in by platform files (section `energy` and `supply`), where every number
// has its source and a range; a chip without these sections has no energy figures.

/// A supply voltage and the highest clock that it allows.
struct OperatingPoint {
  Volts voltage;
  Hertz clock;
};

/// One supply for the whole chip, as on GAP9.
struct SupplyConfig {
  Volts voltage;           ///< 0 if the platform says nothing about energy
  Volts step;              ///< granularity, counted from the lowest voltage
  OperatingPoint lowest;   ///< the highest clocks in between lie on the straight line
  OperatingPoint highest;  ///< from here to there
};

/// Energies and powers at one voltage. Energies of events and of clock cycles scale with the square
/// of the voltage; powers, which do not depend on the clock, scale with the voltage unless said.
struct EnergyConfig {
  Volts voltage;  ///< at which the numbers below hold

  struct Core {
    Joules instruction;    ///< with its fetch from the instruction cache
    Joules f32_operation;  ///< of a floating-point unit, besides the instruction
    Watts leakage;         ///< of a core that works or stalls
    Watts gated_leakage;   ///< of a core that waits for an event, its clock stopped
  } core;

  struct L1 {
    Joules access;       ///< of up to 32 bits
    Watts bank_leakage;  ///< of each bank
  } l1;

  struct Dma {
    Joules transfer_cycle;  ///< in each of the controller's cycles of a transfer
    Joules cycle;           ///< in each clock cycle
    Watts leakage;
  } dma;

  /// The cluster besides its cores, L1 and DMA: interconnect, event unit, instruction caches,
  /// clock.
  struct Cluster {
    Joules cycle;  ///< in each clock cycle
    Watts leakage;
    double idle_clock = 0;  ///< share of the cycles that go on while the cluster has nothing to do
  } cluster;

  struct L2 {
    Joules access;  ///< of up to 32 bits
  } l2;

  /// The rest of the chip: controller besides its core, interconnect, L2 besides accesses,
  /// regulator.
  struct Soc {
    Joules cycle;  ///< in each cycle of the controller's clock
    Watts static_power;
  } soc;

  /// What flows and what the clock takes by the size of what there is (energy/area.h), in place of
  /// the fixed numbers above: leakages and cycles of core, L1, DMA, cluster and soc. All zero where
  /// a platform gives those.
  struct BySize {
    Joules gate_cycle;     ///< of a thousand gates in each clock cycle; a core's instruction has it
    double gated = 0;      ///< share of it of a core whose clock is stopped
    Joules bank_cycle;     ///< of a bank of L1 or a block of L2 in each clock cycle
    Joules stalled_cycle;  ///< of a core that waits with its clock on
    Watts gate_leakage;    ///< of a thousand gates
    Watts l1_leakage;      ///< of a KiB
    Watts l2_leakage;      ///< of a KiB
    double leakage_exponent = 1;  ///< leakage grows with this power of the voltage
  } by_size;

  /// Of an item of a call that an accelerator serves, by kind of kernel.
  using Items = std::array<Joules, work::kOffloadKindCount>;
  Items cluster_accelerators{};
  Items controller_accelerators{};
};

/// The numbers, and all of them at the ends of their ranges. No energy falls when a number rises.
struct EnergyRange {
  EnergyConfig value;
  EnergyConfig low;
  EnergyConfig high;
};

// What the parts of a chip occupy: of each unit, and of the technology. Filled in by the section
// `area` of platform files, where every number has its source and a range; a chip without it has no
// area. What follows from these numbers is worked out in sim/energy/area.h.
//
// Logic is counted in thousands of gate equivalents (kGE: areas of a NAND with two inputs), which
// nearly do not depend on the technology.

using SquareMicrometres = Quantity<struct SquareMicrometresTag, double>;
using KiloGates = Quantity<struct KiloGatesTag, double>;

struct AreaConfig {
  SquareMicrometres gate;       ///< of a thousand gate equivalents, placed; 0: no area is known
  SquareMicrometres sram_cut;   ///< of a memory block of any size: decoders, amplifiers
  SquareMicrometres sram_bit;   ///< and for each of its bits
  SquareMicrometres latch_bit;  ///< of a bit of a memory of latches, with its multiplexers
  Bytes l2_cut;                 ///< size of a memory block of L2

  KiloGates core;                 ///< without extensions and floating-point unit
  KiloGates xpulp;                ///< what a core with Xpulp has besides
  KiloGates fpu;                  ///< without divider
  KiloGates divider;              ///< for quotients and square roots
  KiloGates fpu_crosspoint;       ///< of the network from cores to these units: a core and a unit
  KiloGates memory_crosspoint;    ///< of the networks of L1 and L2: a master and a bank
  double l1_masters = 0;          ///< ports into the network of L1 besides those of cores and DMA
  double l2_masters = 0;          ///< ports into the network of L2
  KiloGates private_cache;        ///< control of a core's instruction cache
  KiloGates shared_cache;         ///< control of the instruction cache that the cores share
  KiloGates cache_way;            ///< comparison and choice, for each way of a bank of a cache
  KiloGates refill_buffer;        ///< for each line that the shared cache can await
  KiloGates int64_unit;           ///< for 64-bit integers
  KiloGates dma;                  ///< control
  KiloGates dma_command;          ///< for each transfer that may be under way
  KiloGates dma_byte;             ///< its data path, for each byte per cycle
  KiloGates event_unit;           ///< for each core
  KiloGates cluster_bus_byte;     ///< the bus to L2, for each byte per cycle
  KiloGates cluster_rest;         ///< other buses, clock crossing, control
  KiloGates not_simulated;        ///< accelerators of the chip that no platform file describes
  KiloGates controller_bus_byte;  ///< its bus for code, for each byte per cycle
  KiloGates controller_rest;      ///< what the controller has besides a core with unit and divider
  KiloGates soc_rest;             ///< peripherals, micro-DMA, power and clock control

  /// Of a unit, by kind of kernel; 0: nobody knows.
  using Accelerators = std::array<KiloGates, work::kOffloadKindCount>;
  Accelerators cluster_accelerators{};
  Accelerators controller_accelerators{};
};

/// The numbers, and all of them at the ends of their ranges.
struct AreaRange {
  AreaConfig value;
  AreaConfig low;
  AreaConfig high;
};

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
