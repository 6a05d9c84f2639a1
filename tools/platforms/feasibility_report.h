// The table of `leviosim platforms feasibility`, with published figures beside the chips that have
// some.
#pragma once

#include <string>
#include <vector>

#include "tools/platforms/feasibility.h"

namespace leviosim::tools {

/// A row per chip, and how to read it.
std::string feasibility_table(const std::vector<Feasibility>& rows);

/// The same with all digits.
std::string feasibility_csv(const std::vector<Feasibility>& rows);

}  // namespace leviosim::tools
