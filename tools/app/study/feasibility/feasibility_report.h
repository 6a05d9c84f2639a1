// The table of `leviosim platforms feasibility`, with published figures beside the chips that have
// some.
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/feasibility/feasibility.h"

namespace leviosim::tools {

/// "fits", or which memory is short of how much, and at which block, or why the work cannot be
/// timed.
std::string memory_verdict(const Feasibility& row);

/// A row per chip, and how to read it.
std::string feasibility_table(const std::vector<Feasibility>& rows);

/// On how many the workload fits, and the fastest of them, in a sentence.
std::string feasibility_conclusion(const std::vector<Feasibility>& rows);

/// Stages by chip: kilocycles of a call, and how many times as fast as on the first; then the
/// frame, and what L1 and L2 are filled to.
std::string stage_comparison(const std::vector<Feasibility>& rows);

/// The first table with all digits.
Table feasibility_rows(const std::vector<Feasibility>& rows);

/// Kilocycles of a call: a row per chip and stage.
Table stage_comparison_rows(const std::vector<Feasibility>& rows);

}  // namespace leviosim::tools
