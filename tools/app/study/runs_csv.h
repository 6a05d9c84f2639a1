// The runs of a study of accuracy as a tidy CSV: a row per run.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/app/study/csv_table.h"
#include "tools/app/study/run_outcome.h"

namespace leviosim::tools {

/// @param leading  cells of a run before the others, such as the values of a sweep
std::string runs_csv(const std::vector<Point>& points, const std::vector<RunOutcome>& outcomes,
                     const Measure& how, const std::function<CsvRow(const Point&)>& leading = {});

}  // namespace leviosim::tools
