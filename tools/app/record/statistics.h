// The figures of a run: statistics with name, unit, description and value, and what follows from
// them. Names are paths ("stages.epnp_ransac.cycles.parallel.mean"); their order is that of the
// workload and never depends on the host. Nothing in here does.
#pragma once

#include <optional>
#include <string>

#include "tools/app/record/statistic_list.h"
#include "tools/app/result/run_figures.h"
#include "tools/app/result/run_result.h"
#include "traces/trajectories/attitude_errors.h"
#include "traces/trajectories/evaluation.h"
#include "traces/trajectories/trajectory_errors.h"

namespace leviosim::tools {

/// What does not exist, such as a mean over no calls, has no value.
RunFigures figures_of(const RunResult& run);

/// "accuracy.ate.rmse" and so on.
/// @param attitude  where it is known, tilt and heading; runs leave it out, since replays do not
///                  know it
void add_ate(StatisticList& list, const traces::Evaluation& evaluation,
             const std::optional<traces::AttitudeErrors>& attitude = {});

/// "accuracy.relative.40m.translation.mean" and so on; null where a length has no sub-trajectory.
void add_relative(StatisticList& list, const traces::Evaluation& evaluation,
                  const traces::RelativeErrors& errors);

/// How such errors are formed.
std::string relative_protocol(const traces::Evaluation& evaluation);

}  // namespace leviosim::tools
