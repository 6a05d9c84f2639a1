// The numbers behind energy: what events cost, what flows without events, and which clocks a supply
// voltage allows. Filled in by platform files (section `energy` and `supply`), where every number
// has its source and a range; a chip without these sections has no energy figures.
#pragma once

#include <array>

#include "sim/base/units.h"
#include "sim/work/offload_regions.h"

namespace leviosim::sim {

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

  /// Memory outside of the chip, whose supply is its own: neither scales with the chip's voltage.
  struct External {
    Joules byte;         ///< of a byte that is moved, with the pins of both ends
    Watts static_power;  ///< refresh and standby, where the workload keeps something there
  } external;

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

}  // namespace leviosim::sim
