#include "tools/app/study/systems/predictions.h"

#include <algorithm>
#include <map>

#include "platform_models/loader/loader.h"
#include "tools/app/flow/flow.h"
#include "tools/app/flow/flow_report.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/run/simulate.h"
#include "tools/app/study/feasibility/feasibility.h"
#include "tools/app/study/feasibility/feasibility_report.h"
#include "tools/app/study/systems/published_systems.h"

namespace leviosim::tools {
namespace {

RunRequest request_for(const PublishedSystem& system, const RunRequest& request) {
  RunRequest own = request;
  own.platform = platform::resolve_platform(system.platform, system.overrides);
  own.cores = own.platform.config.cluster.workers;
  return own;
}

/// Recorded frames stand for faster ones: the work of a frame hardly depends on what is in it.
Prediction predict_flow(const PublishedSystem& system, const RunRequest& request,
                        const ProgressCallback& progress) {
  FlowSource source(request, {});
  const RunResult run = simulate_source(request, source, progress);
  Prediction here;
  here.memory = "fits";
  const std::optional<FlowCycles> cycles = flow_cycles(run);
  if (!cycles) return here;
  here.most_frames_per_s = static_cast<double>(run.cluster_clock.count()) / cycles->parallel;
  here.frames_per_s =
      std::min(system.frames_per_s.value_or(here.most_frames_per_s), here.most_frames_per_s);
  if (const auto energy = energy_of(at_rate(run, here.frames_per_s))) {
    here.power = energy->mean_power();
    here.frame = energy->per_frame();
  }
  return here;
}

/// @param study  of the workload
Prediction predict_levio(const PublishedSystem& system, const RunRequest& request,
                         FeasibilityStudy& study) {
  const Feasibility found = study.on({system.platform, request.platform, request.cores});
  Prediction here;
  here.most_frames_per_s = found.frames_per_second();
  here.power = found.power;
  here.frame = found.energy_per_frame;
  // The rate at which the study takes energy and power.
  here.frames_per_s = here.power && here.frame
                          ? here.power->value.count() / here.frame->value.count()
                          : here.most_frames_per_s;
  here.memory = memory_verdict(found);
  here.fits = found.fits();
  return here;
}

}  // namespace

std::vector<SystemRow> predict_systems(const std::vector<PublishedSystem>& systems,
                                       const RunRequest& request,
                                       const ProgressCallback& progress) {
  std::vector<SystemRow> rows;
  std::map<std::string, FeasibilityStudy> studies;  // by workload
  for (const PublishedSystem& system : systems) {
    if (system.workloads.empty()) rows.push_back({system});
    for (const std::string& workload : system.workloads) {
      const RunRequest own = request_for(system, request);
      if (workload == kFlowWorkload) {
        rows.push_back({system, workload, predict_flow(system, own, progress)});
        continue;
      }
      RunRequest levio = request;
      levio.profile = workload;
      FeasibilityStudy& study = studies.try_emplace(workload, levio, progress).first->second;
      rows.push_back({system, workload, predict_levio(system, own, study)});
    }
  }
  return rows;
}

}  // namespace leviosim::tools
