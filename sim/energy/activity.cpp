#include "sim/energy/activity.h"

#include <algorithm>

#include "sim/chip/accelerator.h"
#include "sim/work/op.h"

namespace leviosim::sim {
namespace {

constexpr double kWord = 4;  // bytes of an access to L1 or L2

double requests(const Demand& demand, Unit unit) {
  return demand.units[static_cast<std::size_t>(unit)].requests;
}

double f32_operations(const Demand& demand) {
  return requests(demand, Unit::Fpu) + requests(demand, Unit::Divider);
}

/// Loads and stores of a core's own memory.
double local_accesses(const Demand& demand) {
  return demand.streamed + demand.scattered + requests(demand, Unit::Bank);
}

/// Loads and stores of L2 by cores that have another memory of their own, and lines of code.
double l2_accesses(const work::Counts& counts, const Demand& demand,
                   const InstructionCacheConfig& icache) {
  return static_cast<double>(counts[work::Op::LoadL2] + counts[work::Op::StoreL2]) +
         requests(demand, Unit::Refill) * static_cast<double>(icache.line.count()) / kWord;
}

/// With code fetched as cores do that are alike; caches without lines answer at once.
Demand team_demand(const work::Counts& counts, const CoreConfig& core,
                   const InstructionCacheConfig& icache, int sharers) {
  if (icache.line == Bytes(0)) return demand_of(counts, core);
  return demand_of(counts, core, CodeFetcher(icache, icache.worker, sharers));
}

/// The workers, used or not, and the master.
double cores_of(const ChipConfig& chip, int workers) {
  return static_cast<double>(std::max(chip.cluster.workers, workers) + 1);
}

/// Core-cycles in which cores worked or stalled; in all others they wait for an event. While the
/// master works alone, the account holds a cycle of every worker for each of his.
double working(const MechanismCycles& team, int workers) {
  double cycles = team.total();
  for (const MechanismInfo& info : kMechanisms)
    if (info.sleeps) cycles -= team[info.mechanism];
  return cycles + team[Mechanism::Serial] / static_cast<double>(workers);
}

}  // namespace

Activity& Activity::operator+=(const Activity& o) {
  instructions += o.instructions;
  f32_operations += o.f32_operations;
  l1_accesses += o.l1_accesses;
  transfer_cycles += o.transfer_cycles;
  l2_accesses += o.l2_accesses;
  controller_instructions += o.controller_instructions;
  controller_f32_operations += o.controller_f32_operations;
  for (std::size_t k = 0; k < work::kOffloadKindCount; ++k) {
    cluster_items[k] += o.cluster_items[k];
    controller_items[k] += o.controller_items[k];
  }
  cluster_cycles += o.cluster_cycles;
  idle_cluster_cycles += o.idle_cluster_cycles;
  soc_cycles += o.soc_cycles;
  cores_working += o.cores_working;
  cores_gated += o.cores_gated;
  controller_working += o.controller_working;
  time += o.time;
  external_bytes += o.external_bytes;
  external_on += o.external_on;
  return *this;
}

Seconds seconds(double cycles, Hertz clock) {
  return Seconds(cycles > 0 ? cycles / static_cast<double>(clock.count()) : 0);
}

Activity cluster_activity(const ChipConfig& chip, int workers, const work::Counts& counts,
                          const work::Transferred& transfers, const MechanismCycles& team,
                          Cycles cycles, const std::vector<work::OffloadWork>& served) {
  const Demand demand = team_demand(counts, chip.cluster.core, chip.cluster.icache, workers);
  const DmaConfig& dma = chip.cluster.dma;
  const auto bytes = static_cast<double>(transfers.bytes.count());
  const auto elapsed = static_cast<double>(cycles.count());
  Activity a;
  a.instructions = demand.alone[Mechanism::Issue];
  a.f32_operations = f32_operations(demand);
  a.l1_accesses = local_accesses(demand) + bytes / kWord;
  const auto external = static_cast<double>(transfers.external.count());
  a.l2_accesses = l2_accesses(counts, demand, chip.cluster.icache) + (bytes + external) / kWord;
  if (transfers.transfers > 0)
    a.transfer_cycles =
        static_cast<double>(transfers.transfers) * dma.first_data + bytes / dma.bytes_per_cycle;
  for (const work::OffloadWork& calls : served) {
    const Service service = service_of(calls, chip.cluster.accelerators);
    a.instructions += service.instructions;
    a.l1_accesses += service.l1_words;
    a.cluster_items[work::index(calls.kernel)] += static_cast<double>(calls.items);
  }
  a.cluster_cycles = elapsed;
  a.time = seconds(elapsed, chip.cluster.clock);
  a.soc_cycles = a.time.count() * static_cast<double>(chip.controller.clock.count());
  a.cores_working = seconds(working(team, workers), chip.cluster.clock);
  a.cores_gated = a.time * cores_of(chip, workers) - a.cores_working;
  return a;
}

Activity controller_activity(const ChipConfig& chip, const work::Counts& counts,
                             const work::Transferred& transfers, Cycles cycles,
                             const std::vector<work::OffloadWork>& served) {
  const Demand demand = team_demand(counts, chip.controller.core, chip.controller.icache, 1);
  Activity a;
  a.controller_instructions = demand.alone[Mechanism::Issue];
  a.controller_f32_operations = f32_operations(demand);
  a.l2_accesses = local_accesses(demand) + l2_accesses(counts, demand, chip.controller.icache) +
                  static_cast<double>(transfers.external.count()) / kWord;
  a.external_bytes = static_cast<double>(transfers.external.count());
  for (const work::OffloadWork& calls : served) {
    a.controller_instructions += service_of(calls, chip.controller.accelerators).instructions;
    a.controller_items[work::index(calls.kernel)] += static_cast<double>(calls.items);
  }
  a.controller_working = seconds(static_cast<double>(cycles.count()), chip.controller.clock);
  return a;
}

Activity idle_activity(const ChipConfig& chip, int workers, Seconds time) {
  Activity a;
  a.time = time;
  a.idle_cluster_cycles = time.count() * static_cast<double>(chip.cluster.clock.count());
  a.soc_cycles = time.count() * static_cast<double>(chip.controller.clock.count());
  a.cores_gated = time * cores_of(chip, workers);
  return a;
}

}  // namespace leviosim::sim
