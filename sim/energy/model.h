// Energy of an activity, by domain of the chip.
//
// Models: a fixed energy per event (instruction, floating-point operation, memory access, cycle of
// a transfer) and per clock cycle of a domain, both proportional to the square of the supply
// voltage; static power proportional to the voltage, as P = a·V²·f + s·V describes the measured
// chip at two points. Hence a change of the clock alone changes neither the energy of a task's
// events nor that of its cycles; it changes how long static power flows.
//
// Where a platform has areas, leakage and clock follow from the size of what there is (area.h), and
// leakage grows with a power of the voltage.
//
// Source of the constants: the platform file's section `energy`.
//
// Leaves out: the data that an instruction works on and which instruction it is; that leakage grows
// with temperature; sleep states, power switches; losses of the regulator that are
// proportional to its load; sensors and pads, and external memory that keeps nothing.
#pragma once

#include <array>
#include <span>

#include "sim/chip/config.h"
#include "sim/energy/activity.h"
#include "sim/energy/domain.h"
#include "sim/energy/estimate.h"

namespace leviosim::sim {

class DomainEnergies {
 public:
  const Estimate<Joules>& operator[](Domain domain) const { return energies_[index(domain)]; }
  Estimate<Joules>& operator[](Domain domain) { return energies_[index(domain)]; }

  Estimate<Joules> total() const;
  DomainEnergies& operator+=(const DomainEnergies& o);

 private:
  std::array<Estimate<Joules>, kDomainCount> energies_{};
};

/// Those that take part: all but external memory where nothing lies there.
std::span<const DomainInfo> domains_of(const DomainEnergies& energies);

/// Whether the platform has energy figures.
bool knows_energy(const ChipConfig& chip);

/// At the chip's supply voltage and clocks. The chip must have energy figures.
DomainEnergies energy_of(const Activity& activity, const ChipConfig& chip);

}  // namespace leviosim::sim
