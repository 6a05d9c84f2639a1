#include "sim/chip/work_sum.h"

namespace leviosim::sim {

void WorkSum::add(const work::Counts& segment, work::CompiledFor code) {
  const CompiledRatios ratios(segment, code);
  for (std::size_t i = 0; i < work::kOpCount; ++i)
    if (segment.n[i] > 0)
      kinds_[i] += ratios.apply(work::kOps[i].op, static_cast<double>(segment.n[i]));
}

WorkSum& WorkSum::operator+=(const WorkSum& other) {
  for (std::size_t i = 0; i < work::kOpCount; ++i) kinds_[i] += other.kinds_[i];
  return *this;
}

LoneCycles WorkSum::cost(const CoreConfig& core) const {
  LoneCycles cycles;
  for (const work::OpInfo& info : work::kOps)
    cost_of(info, kinds_[work::index(info.op)], core).add_to(cycles);
  return cycles;
}

}  // namespace leviosim::sim
