#include "sim/chip/team_memory.h"

namespace leviosim::sim {

bool TeamMemory::has_cores_of(const ClusterConfig& other) const {
  return other.core == config_.core && other.icache == config_.icache &&
         other.accelerators == config_.accelerators;
}

std::optional<std::vector<std::size_t>> TeamMemory::operations_that_differ(
    const ClusterConfig& other) const {
  ClusterConfig with_our_costs = other;
  with_our_costs.core.ops = config_.core.ops;
  if (!has_cores_of(with_our_costs)) return std::nullopt;
  std::vector<std::size_t> operations;
  for (std::size_t i = 0; i < work::kOpCount; ++i)
    if (other.core.ops[i] != config_.core.ops[i]) operations.push_back(i);
  return operations;
}

bool TeamMemory::shares_as(const ClusterConfig& other) const {
  return other.fpu == config_.fpu && other.l1.banks == config_.l1.banks &&
         other.l1.stream_conflicts == config_.l1.stream_conflicts &&
         other.icache.shared_banks == config_.icache.shared_banks &&
         other.icache.refills == config_.icache.refills &&
         other.accelerators == config_.accelerators;
}

}  // namespace leviosim::sim
