// The waits of a core while it works, from the account of cycles: their names, and the cycles of
// each in a work segment.
#pragma once

#include <array>
#include <string_view>

#include "sim/chip/account.h"

namespace leviosim::tools {

struct Wait {
  std::string_view name;

  /// Cycles of all mechanisms that are this wait.
  double of(const sim::MechanismCycles& segment) const {
    double cycles = 0;
    for (const sim::MechanismInfo& info : sim::kMechanisms)
      if (info.wait == name) cycles += segment[info.mechanism];
    return cycles;
  }
};

/// In the order of the mechanisms. @returns how many there are
template <class Visit>
constexpr std::size_t visit_waits(Visit&& visit) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < sim::kMechanisms.size(); ++i) {
    bool is_new = !sim::kMechanisms[i].wait.empty();
    for (std::size_t k = 0; k < i; ++k)
      if (sim::kMechanisms[k].wait == sim::kMechanisms[i].wait) is_new = false;
    if (is_new) visit(count++, sim::kMechanisms[i].wait);
  }
  return count;
}

/// Always in this order, since the order within a segment is not known.
inline constexpr auto kWaits = [] {
  std::array<Wait, visit_waits([](std::size_t, std::string_view) {})> waits;
  visit_waits([&](std::size_t i, std::string_view name) { waits[i].name = name; });
  return waits;
}();

/// Cycles of a work segment in which its core does not wait.
inline double own_work(const sim::MechanismCycles& segment) {
  return segment.alone() - segment[sim::Mechanism::Fetch] - segment[sim::Mechanism::Accelerator];
}

}  // namespace leviosim::tools
