// What the rows of a comparison refer to: tools/app/validation/published/*.csv, compiled into the
// program.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/app/validation/microbench/microbench_row.h"

namespace leviosim::tools {

/// The rows of a reference file, with nothing simulated yet: columns group, name, cores, unit,
/// reference, reference_high (empty if the sources agree), tolerance (relative), source.
/// @throws InputError with file, line and column
std::vector<MicrobenchRow> reference_rows(const std::string& file, std::string_view text, int tier);

/// Sets the guards of rows that a file names: columns group, name, cores, unit, guard (relative),
/// reason. A row's name is what stands before its first comma.
/// @throws InputError with file, line and column, also for a row that does not exist
void take_guards(const std::string& file, std::string_view text, std::vector<MicrobenchRow>& rows);

}  // namespace leviosim::tools
