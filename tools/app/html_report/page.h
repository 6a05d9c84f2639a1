// A report as one HTML file: the template with styles, scripts, the chart library and its licence,
// and the data as JSON, which the scripts draw. Nothing is loaded from elsewhere, and the page's
// policy forbids it. Same data, same bytes.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/base/builtin_file.h"
#include "sim/outputs/output_folder.h"
#include "tools/app/budget/gate.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/html_report/page_json.h"
#include "tools/app/report/statistic_list.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// The data of a report: {"format", "version", "title", "runs": [run_json()…]} and, where there are
/// some, "comparisons", "check", "study".
Json report_json(const std::string& title, Json runs);

/// The file. @param data  of report_json()
std::string html_page(const Json& data);

/// Text that may stand in an element or an attribute.
std::string html_escaped(const std::string& text);

/// JSON that may stand in a <script>: no text of it can end the element.
std::string script_json(const Json& json);

// The files of page/, and the chart library with its licence, as part of the program; generated
// when it is built (tools/embed.cmake).

/// Sorted by path.
std::span<const base::BuiltinFile> page_parts();

// The option --report of commands: claims the file before work is done, writes the page at the end.

/// Declares --report FILE.
void add_report_option(CLI::App& command, std::string& file);

/// None if no file is named. @param inputs  that stay as they are
/// @throws InputError if it cannot be written
std::optional<outputs::OutputFile> claimed_report(const std::string& file, bool replace,
                                                  std::vector<std::filesystem::path> inputs = {},
                                                  const std::string& option = "--report");

/// A run with the files that it left, or would leave.
struct ReportedRun {
  RunRecord record;
  RunFiles files;
};

/// The data of a page about runs. The others are compared with the first.
/// @param check  may be null
Json runs_report(const std::vector<ReportedRun>& runs,
                 const std::vector<RunComparison>& comparisons, const CheckResult* check);

/// How commands that run or replay end: with the page, and what a budget says, if they are asked
/// for.
/// @throws LimitNotMet if a limit is not met
void report_and_check(const ReportedRun& run, std::optional<outputs::OutputFile>& page,
                      const std::optional<Gate>& gate, bool say = true);

/// Writes the page, if there is a file for it.
/// @param say  whether to print where it is
void publish_report(std::optional<outputs::OutputFile>& file, const Json& data, bool say = true);

}  // namespace leviosim::tools
