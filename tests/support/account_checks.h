// What holds of every account of cycles.
#pragma once

#include <gtest/gtest.h>

#include "sim/chip/account.h"

namespace leviosim::sim::testing {

/// That its forks add up to the team's cycles, mechanism by mechanism, and operations to forks.
/// Sums differ by the rounding of double precision only.
inline void expect_adds_up(const CycleAccount& account, bool on_controller) {
  constexpr double kRounding = 1e-9;
  MechanismCycles sum;
  for (const ForkAccount& fork : account.forks) {
    LoneCycles by_operation;
    for (const OperationAccount& operation : fork.operations) by_operation += operation.cycles;
    for (const MechanismInfo& info : kMechanisms) {
      const Mechanism m = info.mechanism;
      const bool alone = !on_controller && fork.name == kSerialFork;
      sum[alone ? Mechanism::Serial : m] += fork.weight * fork.cycles[m];
      if (index(m) >= kLoneMechanismCount) continue;
      EXPECT_NEAR(by_operation[m], fork.cycles[m], kRounding * fork.cycles.total())
          << fork.name << ", " << info.key;
    }
  }
  for (const MechanismInfo& info : kMechanisms)
    EXPECT_NEAR(sum[info.mechanism], account.team[info.mechanism], kRounding * account.total())
        << info.key;
}

}  // namespace leviosim::sim::testing
