#include "sim/chip/chip.h"

#include <cmath>

namespace leviosim::sim {

Chip::Chip(const ChipConfig& config, int workers)
    : config_(config),
      timebase_({{"cluster", config.cluster.clock}, {"controller", config.controller.clock}}),
      cluster_(kernel_, timebase_.clock("cluster"), config.cluster, workers),
      controller_(kernel_, timebase_.clock("controller"), config.controller) {}

Task<JobTiming> Chip::offload(const work::Job& job) {
  const Duration one_way =
      timebase_.clock("controller")
          .duration(
              Cycles(static_cast<std::int64_t>(std::llround(config_.cluster.events.offload))));
  const Time begin = kernel_.now();
  co_await kernel_.delay(one_way);
  JobTiming timing = co_await cluster_.run(job);
  co_await kernel_.delay(one_way);
  timing.begin = begin;
  timing.end = kernel_.now();
  co_return timing;
}

}  // namespace leviosim::sim
