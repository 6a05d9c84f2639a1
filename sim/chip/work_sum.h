// The work of many segments, and what they cost one by one. Each segment has its own ratios of
// compiled code (sim/work/compiled_work.h), so the sum of their counts alone has another cost.
//
// Left out: code that caches lack, and what cores do to each other.
#pragma once

#include "sim/chip/account.h"
#include "sim/chip/cost.h"
#include "sim/work/counts.h"

namespace leviosim::sim {

class WorkSum {
 public:
  WorkSum() = default;
  WorkSum(const work::Counts& segment, work::CompiledFor code) { add(segment, code); }

  /// @param code  of the cores that will execute it
  void add(const work::Counts& segment, work::CompiledFor code);
  WorkSum& operator+=(const WorkSum& other);

  /// For a core that runs alone.
  LoneCycles cost(const CoreCosts& core) const;

 private:
  std::array<OperationsOfKind, work::kOpCount> kinds_{};
};

}  // namespace leviosim::sim
