#include "sim/chip/controller.h"

#include <cmath>

namespace leviosim::sim {
namespace {

work::Counts counts_of(const work::StageRun& stage) {
  work::Counts sum;
  for (const work::Step& step : stage.steps) {
    if (const auto* serial = std::get_if<work::Serial>(&step)) sum += serial->counts;
    if (const auto* fork = std::get_if<work::Fork>(&step))
      for (const work::Counts& share : fork->shares) sum += share;
  }
  return sum;
}

}  // namespace

Task<JobTiming> Controller::run(const work::Job& job) {
  JobTiming timing{kernel_.now(), kernel_.now(), {}};
  for (const work::StageRun& stage : job.stages) {
    const Demand demand = price(counts_of(stage), config_.core);
    StageTiming s{stage.stage, kernel_.now(), {}, {}, {}};
    s.cycles = Cycles(static_cast<std::int64_t>(std::ceil(demand.cycles())));
    s.account.useful = demand.alone;
    s.account.rounding = static_cast<double>(s.cycles.count()) - demand.cycles();
    co_await kernel_.delay(clock_.duration(s.cycles));
    s.end = kernel_.now();
    timing.stages.push_back(s);
  }
  timing.end = kernel_.now();
  co_return timing;
}

}  // namespace leviosim::sim
