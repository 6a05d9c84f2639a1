// The runs of a study of accuracy as a tidy table: a row per run.
#pragma once

#include <vector>

#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/point.h"

namespace leviosim::tools {

struct FinishedRun {
  const Point& point;
  const RunOutcome& outcome;
};
using RunColumns = Columns<FinishedRun>;

/// @param columns  those before the others, such as the values of a sweep
Table run_rows(const std::vector<Point>& points, const std::vector<RunOutcome>& outcomes,
               const Measure& how, RunColumns columns = {});

}  // namespace leviosim::tools
