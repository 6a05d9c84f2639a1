// The runs of a study of accuracy as a tidy table: a row per run.
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/batch_plan.h"
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

/// run_outcomes() as the plan says.
std::vector<RunOutcome> run_outcomes(const BatchPlan& plan, const std::vector<Point>& points);

/// "SE3-aligned, relative errors over 40 m, …": how the errors of the plan are formed.
std::string measure_text(const Measure& how);

}  // namespace leviosim::tools
