#include "sim/energy/activity.h"

#include <algorithm>

#include "sim/chip/cost.h"

namespace leviosim::sim {
namespace {

constexpr double kWord = 4;  // bytes: width of L1 ports and of what an L2 access is counted in

double l2_words(const work::Counts& counts) {
  return static_cast<double>(counts[work::Op::LoadL2] + counts[work::Op::StoreL2]);
}

/// The workers, used or not, and the master.
double cores_of(const ChipConfig& chip, int workers) {
  return static_cast<double>(std::max(chip.cluster.workers, workers) + 1);
}

/// Core-cycles in which cores worked or stalled; in all others they wait for an event. While the
/// master works alone, the account holds a cycle of every worker for each of his.
double working(const Account& account, int workers) {
  return account.total() - account.imbalance - account.synchronisation - account.transfer -
         account.serial + account.serial / static_cast<double>(workers);
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
  cluster_cycles += o.cluster_cycles;
  idle_cluster_cycles += o.idle_cluster_cycles;
  soc_cycles += o.soc_cycles;
  cores_working += o.cores_working;
  cores_gated += o.cores_gated;
  controller_working += o.controller_working;
  time += o.time;
  return *this;
}

Seconds seconds(double cycles, Hertz clock) {
  return Seconds(cycles > 0 ? cycles / static_cast<double>(clock.count()) : 0);
}

Activity cluster_activity(const ChipConfig& chip, int workers, const work::Counts& counts,
                          const work::Transferred& transfers, const Account& account,
                          Cycles cycles) {
  const Demand demand = price(counts, chip.cluster.core);
  const DmaConfig& dma = chip.cluster.dma;
  const auto bytes = static_cast<double>(transfers.bytes.count());
  const auto elapsed = static_cast<double>(cycles.count());
  Activity a;
  a.instructions = demand.alone.issue;
  a.f32_operations = demand.fpu_ops + demand.divisions;
  a.l1_accesses = demand.l1_accesses + bytes / kWord;
  a.l2_accesses = l2_words(counts) + bytes / kWord;
  if (transfers.transfers > 0)
    a.transfer_cycles =
        static_cast<double>(transfers.transfers) * dma.first_data + bytes / dma.bytes_per_cycle;
  a.cluster_cycles = elapsed;
  a.time = seconds(elapsed, chip.cluster.clock);
  a.soc_cycles = a.time.count() * static_cast<double>(chip.controller.clock.count());
  a.cores_working = seconds(working(account, workers), chip.cluster.clock);
  a.cores_gated = a.time * cores_of(chip, workers) - a.cores_working;
  return a;
}

Activity controller_activity(const ChipConfig& chip, const work::Counts& counts, Cycles cycles) {
  const Demand demand = price(counts, chip.controller.core);
  Activity a;
  a.controller_instructions = demand.alone.issue;
  a.controller_f32_operations = demand.fpu_ops + demand.divisions;
  a.l2_accesses = demand.l1_accesses + l2_words(counts);
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
