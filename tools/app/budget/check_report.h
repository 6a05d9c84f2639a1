// What a check found, as text of 80 columns and as JSON. What CI servers read: ci_files.h.
#pragma once

#include <string>

#include "tools/app/budget/check.h"
#include "tools/app/cli/printout.h"
#include "tools/app/report/statistic_list.h"

namespace leviosim::tools {

/// A line per limit, and for those that are not met by how much, where, why, reason and owner.
std::string check_text(const CheckResult& result);

/// Both as parts of a screen, with a verdict at their end.
/// @param next  what to do about limits that are not met
Printout check_printout(const CheckResult& result, std::vector<std::string> next);

Json check_json(const CheckResult& result);

}  // namespace leviosim::tools
