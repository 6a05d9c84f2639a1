// Where and why a limit was missed: the stage, and the forks and mechanisms with most of the
// excess, or the blocks of a memory; against the baseline if there is one, else the largest parts
// of the run.
#pragma once

#include "tools/app/budget/check.h"
#include "tools/app/record/record.h"

namespace leviosim::tools {

/// Fills in `where` and `why` of the findings that are not met.
/// @param baseline  may be null
void explain(CheckResult& result, const RunRecord& run, const RunRecord* baseline);

}  // namespace leviosim::tools
