#include "sim/chip/controller.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sim/base/error.h"
#include "sim/chip/accelerator.h"
#include "sim/events/time_limit.h"

namespace leviosim::sim {

Task<JobTiming> Controller::run(const work::Job& job) {
  JobTiming timing{kernel_.now(), kernel_.now(), {}};
  for (const work::StageRun& stage : job.stages) {
    const Demand demand = demand_of(stage);
    StageTiming s{stage.stage, kernel_.now(), {}, {}, {}};
    const double transfer = transfer_cycles(stage);
    s.cycles = counted_cycles(std::ceil(demand.cycles() + transfer));
    s.breakdown.useful = demand.alone;
    s.breakdown.transfer = transfer;
    s.breakdown.rounding = static_cast<double>(s.cycles.count()) - demand.cycles() - transfer;
    co_await kernel_.delay(clock_.duration(s.cycles));
    s.end = kernel_.now();
    timing.stages.push_back(s);
  }
  timing.end = kernel_.now();
  co_return timing;
}

Demand Controller::demand_of(const work::StageRun& stage) const {
  if (!has_accelerators(config_.accelerators))
    return price(work::counts_of(stage), config_.core, code_);
  return price(work::segments_of(stage), config_.core, config_.accelerators, code_);
}

/// Only external memory is far from a controller.
double Controller::transfer_cycles(const work::StageRun& stage) const {
  const ExternalMemoryConfig& memory = config_.external;
  double seconds = 0;
  for (const work::Step& step : stage.steps) {
    const auto* transfer = std::get_if<work::Transfer>(&step);
    if (transfer == nullptr || work::is_between_l1_and_l2(transfer->direction)) continue;
    if (memory.bytes_per_second <= 0)
      throw InputError(fmt::format(
          "{}: the work moves data from or to external memory, which the platform has not",
          stage.stage));
    const Bytes moved = std::max(transfer->bytes, memory.burst);
    seconds +=
        memory.latency_seconds + static_cast<double>(moved.count()) / memory.bytes_per_second;
  }
  return seconds * static_cast<double>(config_.clock.count());
}

}  // namespace leviosim::sim
