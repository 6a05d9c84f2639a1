// A comparison for people and programs: text of 80 columns, Markdown, CSV (a row per quantity of
// the tree), JSON (the tree). Text and Markdown show the largest parts and the sum of the others;
// CSV and JSON hold all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/comparison/comparison.h"

namespace leviosim::tools {

enum class ReportFormat { text, markdown, json, csv };

/// @throws InputError for another name than text, markdown, json, csv
ReportFormat parse_report_format(const std::string& name);

std::string comparison_report(const RunComparison& comparison, ReportFormat format);
/// The same of several, one after the other; in JSON a list if there is more than one.
/// @param all  else text is the summary
std::string comparison_report(const std::vector<RunComparison>& comparisons, ReportFormat format,
                              bool all);

/// At most 24 lines of 80 columns: figures of the run, the stages that differ most, and the main
/// causes. More lines only for notes.
std::string comparison_summary(const RunComparison& comparison);

/// Cycles of a call, or of a frame, of a model beside what was measured.
struct ModelError {
  std::string stage;
  std::optional<double> measured;
  std::optional<double> model;
  std::optional<double> percent;  ///< of what was measured
};
/// Of each stage, and last of the frame, where one of the runs was measured (A, if both were).
std::vector<ModelError> model_errors(const RunComparison& comparison);

/// A table of them, and their mean.
std::string measured_report(const RunComparison& comparison, bool markdown);

/// "8-point hypotheses: issue +1.2 %": the parts of a stage that explain most of its difference,
/// each with its share of the stage's cycles in A.
/// @param most  of them at most
std::vector<std::string> reasons(const StageComparison& stage, std::size_t most);

/// The name of a part for people: what a mechanism is, else as it is.
std::string part_label(const std::string& name);

/// One line about the work: the same, or where it is not.
std::string work_line(const RunComparison& comparison);

}  // namespace leviosim::tools
