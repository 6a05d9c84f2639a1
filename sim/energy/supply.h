// Which clocks a supply voltage allows.
//
// Models: the highest clock as a straight line between two measured points; voltages in the steps
// of the supply. Leaves out: temperature, process, a limit of its own for each clock domain, and
// voltages outside the two points.
#pragma once

#include <optional>

#include "sim/chip/energy_config.h"

namespace leviosim::sim {

/// Whether the supply can be set to this voltage: between its lowest and highest one, in steps.
bool can_supply(const SupplyConfig& supply, Volts voltage);

/// Highest clock at a voltage between the two points.
Hertz highest_clock(const SupplyConfig& supply, Volts voltage);

/// Lowest voltage that the supply can be set to and that allows the clock, if there is one.
std::optional<Volts> lowest_voltage(const SupplyConfig& supply, Hertz clock);

}  // namespace leviosim::sim
