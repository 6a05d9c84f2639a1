// What the rows of a comparison refer to: tools/app/validation/published/*.csv, compiled into the
// program.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/app/validation/microbench/row.h"

namespace leviosim::tools {

/// The rows of a reference file, with nothing simulated yet: columns group, name, cores, unit,
/// reference, reference_high (empty if the sources agree), tolerance (relative), source.
/// @throws InputError with file, line and column
std::vector<MicrobenchRow> reference_rows(const std::string& file, std::string text, int tier);

}  // namespace leviosim::tools
