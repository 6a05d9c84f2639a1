// A run as a list of statistics, each with name, unit, description and value: the content of
// stats.json. Names are paths ("stages.epnp_ransac.cycles.parallel.mean"); their order is that of
// the workload and never depends on the host. Nothing in here does.
#pragma once

#include <string>

#include "tools/app/report/statistic_list.h"
#include "tools/app/result/run_figures.h"
#include "tools/app/result/run_result.h"

namespace leviosim::tools {

/// {"format": "leviosim statistics", "version": N, "statistics": [{"name", "unit", "description",
/// "value"}, …]}. What does not exist (a mean over no calls) is null. Accuracy figures also carry
/// "protocol".
Json statistics(const RunResult& run);

/// The figures of a run that lies in memory.
RunFigures figures_of(const RunResult& run);

/// The content of stats.json, with one statistic on a line, so that runs can be compared
/// line by line.
std::string statistics_text(const RunResult& run);

}  // namespace leviosim::tools
