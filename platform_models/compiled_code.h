// Sizes of a workload's compiled code, which instruction-cache footprints come from. code/*.csv is
// measured by tools/rv32 and part of the program.
#pragma once

#include <string>
#include <string_view>

#include "sim/work/code_map.h"

namespace leviosim::platform {

/// The pieces of all named functions of the workload as compiled for RV32IMFC.
const work::CodeMap& compiled_code();

/// From the text of such a file: comments (#), a header, then rows that begin with
/// function,after,lines; `after` is empty for what runs from the function's entry on, and lines are
/// the mean number of distinct 16-byte lines that one visit fetches.
/// @throws InputError with file and line
work::CodeMap code_map_from(const std::string& file, std::string_view text);

}  // namespace leviosim::platform
