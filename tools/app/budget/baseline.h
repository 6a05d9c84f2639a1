// A baseline: what a budget needs of an earlier run, in a few kilobytes of JSON with a figure on a
// line, made for version control. It holds the facts of the run, the figures that most limits are
// about, those that a budget names, the blocks at the highest peak of L1, and the larger parts of
// every stage's cycles; parts below one per cent of a stage are one.
#pragma once

#include <string>
#include <vector>

#include "tools/app/budget/budget.h"
#include "tools/app/comparison/run_record.h"

namespace leviosim::tools {

/// The text of a baseline. @param budget  whose further statistics it holds too; may be null
std::string baseline_text(const RunRecord& run, const Budget* budget);

/// @throws InputError for what is no baseline
RunRecord parse_baseline(const std::string& name, const std::string& text);

}  // namespace leviosim::tools
