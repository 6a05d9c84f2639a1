// Changes of a file of budgets that people review: limits that lost their slack, and regressions
// that are accepted until a day. What else stands in the file stays as it is, comments included.
#pragma once

#include <string>

#include "tools/app/budget/check.h"
#include "tools/app/comparison/run_record.h"

namespace leviosim::tools {

/// The file with absolute limits that leave no more than `slack` per cent of what the run needs;
/// tighter ones stay. @param text  of the budget's file
std::string tightened(const Budget& budget, const std::string& text, const RunRecord& run,
                      double slack);

/// The file with an entry under `accepted` for each limit that fails.
/// @throws InputError for a day that is none, and if no limit fails
std::string with_accepted(const std::string& text, const CheckResult& result,
                          const std::string& reason, const std::string& until);

/// "2026-12-24". @throws InputError that begins with `where`
std::string parse_day(const std::string& where, const std::string& text);

/// Of the clock in UTC, or what SOURCE_DATE_EPOCH in the environment says.
std::string today();

// A first budget for a run: what it needs today and a margin, to be edited by people.

/// The text of a budget file that the run meets. @param margin  in per cent
std::string first_budget(const RunRecord& run, double margin);

/// "5 %". @throws InputError that names the option, unless it is a share from 0 to 1000 %
double parse_share(const std::string& option, const std::string& text);

}  // namespace leviosim::tools
