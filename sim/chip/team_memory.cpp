#include "sim/chip/team_memory.h"

namespace leviosim::sim {

bool TeamMemory::has_cores_of(const ClusterConfig& other) const {
  return other.core == config_.core && other.icache == config_.icache &&
         other.accelerators == config_.accelerators;
}

bool TeamMemory::shares_as(const ClusterConfig& other) const {
  return other.fpu == config_.fpu && other.l1.banks == config_.l1.banks &&
         other.l1.stream_conflicts == config_.l1.stream_conflicts &&
         other.icache.shared_banks == config_.icache.shared_banks &&
         other.icache.refills == config_.icache.refills &&
         other.accelerators == config_.accelerators;
}

}  // namespace leviosim::sim
