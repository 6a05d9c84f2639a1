// The work of many segments, and what pricing them one by one adds up to. Each segment has its own
// ratios of compiled code (sim/work/compiled_work.h), so the sum of their counts alone has not
// their price.
//
// Left out: code that caches lack, and what cores do to each other.
#pragma once

#include "sim/chip/cost.h"

namespace leviosim::sim {

class WorkSum {
 public:
  WorkSum() = default;
  WorkSum(const work::Counts& segment, work::CompiledFor code) { add(segment, code); }

  /// @param code  of the cores that it will be priced for
  void add(const work::Counts& segment, work::CompiledFor code);
  WorkSum& operator+=(const WorkSum& other);

  double count(work::Op op) const { return kinds_[work::index(op)].count; }
  /// What the operations of one kind cost a core that runs alone. The prices of all kinds add up.
  UsefulCycles price(work::Op op, const CoreConfig& core) const;
  UsefulCycles price(const CoreConfig& core) const;

 private:
  std::array<OperationsOfKind, work::kOpCount> kinds_{};
};

}  // namespace leviosim::sim
