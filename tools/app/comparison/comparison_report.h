// A comparison for people and programs: text of 80 columns, Markdown, CSV (a row per quantity of
// the tree), JSON (the tree). Text and Markdown show the largest parts and the sum of the others;
// CSV and JSON hold all.
#pragma once

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

}  // namespace leviosim::tools
