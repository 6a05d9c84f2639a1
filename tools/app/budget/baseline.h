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

/// A figure that is not a stage's, and its value: whole numbers without a fraction, or null.
struct BaselineFigure {
  std::string name;
  std::string unit;
  Json value;
};
/// What a baseline without a budget holds, in two parts: figures of the run, and stages with theirs
/// and the larger parts of their cycles, if they have any. @throws InputError if it is not known where cycles went
std::vector<BaselineFigure> baseline_figures(const RunRecord& run);
std::vector<Json> baseline_stages(const RunRecord& run);
/// The inverse of the second: adds the stage, its figures and its cycles.
/// @throws nlohmann::json::exception, InputError for what is no such stage
void add_baseline_stage(const Json& stage, RunRecord& run);

/// The text of a baseline. @param budget  whose further statistics it holds too; may be null
std::string baseline_text(const RunRecord& run, const Budget* budget);

/// @throws InputError for what is no baseline
RunRecord parse_baseline(const std::string& name, const std::string& text);

}  // namespace leviosim::tools
