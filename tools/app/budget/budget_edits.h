// Edits of a budget file, for people to review: limits tightened to a run, and regressions accepted
// until a day. The rest of the file stays as it is, comments included.
#pragma once

#include <string>
#include <vector>

#include "tools/app/budget/budget.h"
#include "tools/app/budget/check.h"
#include "tools/app/record/record.h"

namespace leviosim::tools {

/// The file with absolute limits that leave no more than `slack` per cent of what the run needs;
/// tighter ones stay. @param text  of the budget's file
std::string tightened(const Budget& budget, const std::string& text, const RunRecord& run,
                      double slack);

/// A miss to accept.
struct Acceptance {
  std::vector<std::string> limits = {};  ///< titles; none: the one that fails
  double margin = 0;                     ///< distance from the value to the new bound [%]
  std::string reason;
  std::string until;  ///< the last day
};

/// The file with an entry under `accepted` for each of these limits, whose bound is what the run
/// needs and the margin.
/// @throws InputError for a day that is none, for a limit that does not fail, and, where none is
///         named, unless one fails
std::string with_accepted(const std::string& text, const CheckResult& result,
                          const Acceptance& acceptance);

}  // namespace leviosim::tools
