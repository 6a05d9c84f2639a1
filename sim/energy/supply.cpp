#include "sim/energy/supply.h"

#include <cmath>

namespace leviosim::sim {
namespace {

// Steps are decimal fractions of a volt: 0.65 + 3 · 0.05 misses 0.8 by rounding.
constexpr double kRounding = 1e-9;

}  // namespace

bool can_supply(const SupplyConfig& supply, Volts voltage) {
  const double steps = (voltage - supply.lowest.voltage).count() / supply.step.count();
  return steps > -kRounding && voltage.count() < supply.highest.voltage.count() + kRounding &&
         std::abs(steps - std::round(steps)) < kRounding;
}

Hertz highest_clock(const SupplyConfig& supply, Volts voltage) {
  const double span = (supply.highest.voltage - supply.lowest.voltage).count();
  if (!(span > 0)) return supply.highest.clock;
  const double share = (voltage - supply.lowest.voltage).count() / span;
  const auto rise = static_cast<double>((supply.highest.clock - supply.lowest.clock).count());
  // Whole hertz, to the nearest: a clock that lies on the line is allowed.
  return supply.lowest.clock + Hertz(std::llround(share * rise));
}

std::optional<Volts> lowest_voltage(const SupplyConfig& supply, Hertz clock) {
  for (int steps = 0;; ++steps) {
    const Volts voltage = supply.lowest.voltage + supply.step * static_cast<double>(steps);
    if (!can_supply(supply, voltage)) return std::nullopt;
    if (highest_clock(supply, voltage) >= clock) return voltage;
  }
}

}  // namespace leviosim::sim
