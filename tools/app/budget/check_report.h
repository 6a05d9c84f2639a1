// What a check found, as text of 80 columns, as JSON, and as CI servers read it.
#pragma once

#include <string>
#include <vector>

#include "tools/app/budget/check.h"
#include "tools/app/cli/printout.h"

namespace leviosim::tools {

/// A line per limit, and for those that are not met by how much, where, why, reason and owner, as
/// parts of a screen, with a verdict at their end.
/// @param next  what to do about limits that are not met
Printout check_printout(const CheckResult& result, std::vector<std::string> next);

Json check_json(const CheckResult& result);

}  // namespace leviosim::tools
