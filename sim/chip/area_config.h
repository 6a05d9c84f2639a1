// What the parts of a chip occupy: of each unit, and of the technology. Filled in by the section
// `area` of platform files, where every number has its source and a range; a chip without it has no
// area. What follows from these numbers is worked out in sim/energy/area.h.
//
// Logic is counted in thousands of gate equivalents (kGE: areas of a NAND with two inputs), which
// nearly do not depend on the technology.
#pragma once

#include <array>

#include "sim/base/units.h"
#include "sim/work/offload_regions.h"

namespace leviosim::sim {

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

}  // namespace leviosim::sim
