// The runs of a batch as a tidy CSV: a row per run.
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/batch/run_batch.h"

namespace leviosim::tools {

/// Cells that stand before the others in every row, such as the values of a sweep.
struct LeadingColumns {
  std::vector<std::string> names{};
  std::vector<std::vector<std::string>> cells{};  ///< by run; none if there are no names
};

/// Text of others as one cell: what would end it becomes a blank.
std::string csv_cell(std::string text);

std::string runs_csv(const std::vector<BatchRun>& runs, const std::vector<RunOutcome>& outcomes,
                     const Measure& how, const LeadingColumns& leading = {});

}  // namespace leviosim::tools
