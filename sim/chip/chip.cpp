#include "sim/chip/chip.h"

#include <cmath>

#include "sim/events/last_time.h"
#include "sim/events/timebase.h"
#include "sim/work/op.h"

namespace leviosim::sim {
namespace {

/// What the cluster awaits from L2 takes its time on the clock of the SoC, which is the
/// controller's (FACTS.md#l2-and-interconnect): in cycles of a faster cluster it takes longer.
ChipConfig in_cluster_cycles(ChipConfig chip) {
  ClusterConfig& cluster = chip.cluster;
  const double ratio = static_cast<double>(cluster.clock.count()) /
                       static_cast<double>(chip.controller.clock.count());
  for (const work::Op op : {work::Op::LoadL2, work::Op::StoreL2})
    cluster.core.ops[work::index(op)].stall *= ratio;
  cluster.icache.shared_miss *= ratio;
  cluster.icache.refill_width /= ratio;
  cluster.dma.first_data *= ratio;
  cluster.dma.bytes_per_cycle /= ratio;
  return chip;
}

}  // namespace

Timebase timebase_of(const ChipConfig& config) {
  return Timebase({{"cluster", config.cluster.clock}, {"controller", config.controller.clock}});
}

Chip::Chip(const ChipConfig& config, int workers)
    : config_(in_cluster_cycles(config)),
      timebase_(timebase_of(config)),
      cluster_(kernel_, timebase_.clock("cluster"), config_.cluster, workers),
      controller_(kernel_, timebase_.clock("controller"), config.controller),
      core_(kernel_, "core", 1) {}

Task<> Chip::take_core() {
  if (config_.controller.shares_core) co_await core_.acquire();
}

void Chip::leave_core() {
  if (config_.controller.shares_core) core_.release();
}

namespace {

JobTiming of_known(Time begin, Duration takes) {
  const JobTiming timing{begin, begin + takes, {}};
  if (timing.end > kLastTime) fail_beyond_time();
  return timing;
}

}  // namespace

Task<JobTiming> Chip::control(const work::Job& job, std::optional<Cycles> known) {
  co_await take_core();
  JobTiming timing = known ? of_known(kernel_.now(), controller_.clock().duration(*known))
                           : controller_.time(job, kernel_.now());
  co_await kernel_.at(timing.end);
  leave_core();
  co_return timing;
}

Task<JobTiming> Chip::offload(const work::Job& job, std::optional<Cycles> known) {
  co_await take_core();
  JobTiming timing = time_offload(job, kernel_.now(), known);
  co_await kernel_.at(timing.end);
  leave_core();
  co_return timing;
}

JobTiming Chip::time_offload(const work::Job& job, Time begin, std::optional<Cycles> known) {
  const Duration one_way =
      timebase_.clock("controller")
          .duration(counted_cycles(std::round(config_.cluster.events.offload)));
  JobTiming timing = known ? of_known(begin + one_way, cluster_.clock().duration(*known))
                           : cluster_.time(job, begin + one_way);
  timing.begin = begin;
  timing.end = timing.end + one_way;
  return timing;
}

}  // namespace leviosim::sim
