// Rows of a comparison with hardware, for people and for programs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/app/table/table.h"
#include "tools/app/validation/microbench/microbench_row.h"

namespace leviosim::tools {

/// Grouped, with the error of each row, a line that sums up, and a warning for each row that is
/// worse than its tolerance or guard.
std::string microbench_table(std::string_view chip, const std::vector<MicrobenchRow>& rows);
/// How many references lie inside their bands, and what plain code is short of.
/// @param needed  needed_instructions(), rising
std::string coverage_text(const std::vector<MicrobenchRow>& rows,
                          const std::vector<double>& needed);
/// Whether all rows are as near as they have to be, in a sentence.
std::string microbench_conclusion(const std::vector<MicrobenchRow>& rows);
Table microbench_rows(const std::vector<MicrobenchRow>& rows);

/// Mean of the absolute errors.
double mean_error(const std::vector<MicrobenchRow>& rows);

}  // namespace leviosim::tools
