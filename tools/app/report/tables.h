// The tables that `leviosim run --tables` prints. Pure functions of
// the result. Columns that do not fit into the width are left out; lines of text may be longer.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/app/result/run_result.h"
#include "tools/app/table/table.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {

/// Stages: calls, kilocycles of a mean call on one core and on N, speed-up, milliseconds.
std::string stage_table(const RunResult& run, int width = table_width());

/// A line that says of which stages a share worth mentioning has no measured code; empty if of
/// none.
std::string unmeasured_note(const RunResult& run);

/// The stage table of these stages, without a title.
/// @param mark_of_controller  behind names of stages there
Table stages_of(const RunResult& run, const std::vector<const StageResult*>& stages,
                std::string_view mark_of_controller);

/// Breakdown of the team's core-cycles in the stages of the cluster, in per cent. Each row adds up
/// to 100.0 as printed.
std::string breakdown_table(const RunResult& run, int width = table_width());

/// Peaks in L1 and L2, and the blocks that were alive at them.
std::string memory_table(const RunResult& run, int width = table_width());

/// What --tables names, in the order in which they are printed.
std::vector<std::string> table_names();

/// These tables, or all, as far as they apply: a native run has no timing and no occupation.
std::string report(const RunResult& run, const std::vector<std::string>& names = {},
                   int width = table_width());

/// Per cent with one decimal that add up to 100.0: each part is rounded down, and the largest
/// remainders are rounded up. All zero if the parts add up to nothing.
std::vector<double> tenths_of_percent(const std::vector<double>& parts);

}  // namespace leviosim::tools
