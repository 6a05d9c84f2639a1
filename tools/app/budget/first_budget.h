// A first budget for a run: its values and a margin, to be edited by people.
#pragma once

#include <string>

#include "tools/app/record/record.h"

namespace leviosim::tools {

/// The text of a budget file that the run meets. @param margin  in per cent
std::string first_budget(const RunRecord& run, double margin);

/// "5 %". @throws InputError that names the option, unless it is a share from 0 to 1000 %
double parse_share(const std::string& option, const std::string& text);

}  // namespace leviosim::tools
