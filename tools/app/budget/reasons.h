// Where a limit was missed, and why: the stage, what its cores did and by which mechanism, or the
// blocks of a memory; against the baseline if there is one, else what weighs most in the run.
#pragma once

#include "tools/app/budget/check.h"
#include "tools/app/record/record.h"

namespace leviosim::tools {

/// Fills in `where` and `why` of the findings that are not met.
/// @param baseline  may be null
void explain(CheckResult& result, const RunRecord& run, const RunRecord* baseline);

}  // namespace leviosim::tools
