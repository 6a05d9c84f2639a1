#include "tools/sensitivity/recorded_run.h"

namespace leviosim::tools {
namespace {

work::Job timing_part(work::Job job) {
  for (work::StageRun& stage : job.stages) stage.memory = {};
  return job;
}

}  // namespace

void RecordedRun::on_front_end(const FrontEndJob& event) {
  frames_.push_back({event.result.source, timing_part(event.job)});
}

void RecordedRun::on_optimiser(const OptimiserJob& event) {
  iterations_.push_back(timing_part(event.job));
}

}  // namespace leviosim::tools
