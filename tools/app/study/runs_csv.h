// The runs of a study of accuracy as a tidy CSV: a row per run.
#pragma once

#include <string>
#include <vector>

#include "sim/base/csv_table.h"
#include "tools/app/study/run_outcome.h"

namespace leviosim::tools {

struct FinishedRun {
  const Point& point;
  const RunOutcome& outcome;
};
using RunColumns = base::CsvTable<FinishedRun>;

/// @param columns  those before the others, such as the values of a sweep
std::string runs_csv(const std::vector<Point>& points, const std::vector<RunOutcome>& outcomes,
                     const Measure& how, RunColumns columns = {});

/// Text of others as a cell that needs no quotes: what would end it becomes a blank.
std::string plain_cell(std::string text);

}  // namespace leviosim::tools
