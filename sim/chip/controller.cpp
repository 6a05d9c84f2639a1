#include "sim/chip/controller.h"

#include <cmath>

namespace leviosim::sim {

Task<JobTiming> Controller::run(const work::Job& job) {
  JobTiming timing{kernel_.now(), kernel_.now(), {}};
  for (const work::StageRun& stage : job.stages) {
    const Demand demand = price(work::counts_of(stage), config_.core, code_);
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
