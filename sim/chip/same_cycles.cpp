#include "sim/chip/same_cycles.h"

#include <tuple>

namespace leviosim::sim {
namespace {

// All members by name: one that is added does not compile until it is here.

auto members_of(const DmaConfig& dma) {
  const auto& [programming, first_data, bytes_per_cycle, completion, commands, call] = dma;
  return std::tuple(programming, first_data, bytes_per_cycle, completion, commands, call);
}

auto members_of(const EventUnitConfig& events) {
  const auto& [fork_master, fork_worker, barrier, offload, fork_again] = events;
  return std::tuple(fork_master, fork_worker, barrier, offload, fork_again);
}

bool same_cluster(const ClusterConfig& a, const ClusterConfig& b) {
  const auto& [clock, workers, max_workers, core, fpu, icache, l1, dma, events, accelerators] = a;
  const auto& [size, banks, stream_conflicts] = l1;
  // Clocks are compared as a ratio, sizes with what the work needs; more workers than a team has
  // do nothing.
  static_cast<void>(clock);
  static_cast<void>(max_workers);
  static_cast<void>(size);
  return workers == b.workers && core == b.core && fpu == b.fpu && icache == b.icache &&
         banks == b.l1.banks && stream_conflicts == b.l1.stream_conflicts &&
         members_of(dma) == members_of(b.dma) && members_of(events) == members_of(b.events) &&
         accelerators == b.accelerators;
}

bool same_controller(const ControllerConfig& a, const ControllerConfig& b, bool moves_external) {
  const auto& [clock, core, icache, external, shares_core, accelerators] = a;
  const auto& [latency_seconds, bytes_per_second, burst, size] = external;
  static_cast<void>(size);  // compared with what the work needs
  const bool same_external = latency_seconds == b.external.latency_seconds &&
                             bytes_per_second == b.external.bytes_per_second &&
                             burst == b.external.burst && (clock == b.clock || !moves_external);
  return core == b.core && icache == b.icache && same_external && shares_core == b.shares_core &&
         accelerators == b.accelerators;
}

}  // namespace

bool takes_same_cycles(const ChipConfig& a, const ChipConfig& b, bool external) {
  const auto ratio = [](const ChipConfig& chip) {
    return static_cast<double>(chip.cluster.clock.count()) /
           static_cast<double>(chip.controller.clock.count());
  };
  return same_cluster(a.cluster, b.cluster) &&
         same_controller(a.controller, b.controller, external) && ratio(a) == ratio(b);
}

}  // namespace leviosim::sim
