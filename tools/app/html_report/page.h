// A report as one HTML file: the template with styles, scripts, the chart library and its licence,
// and the data as JSON, which the scripts draw. Nothing is loaded from elsewhere, and the page's
// policy forbids it. Same data, same bytes.
#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/builtin_file.h"
#include "sim/outputs/output_folder.h"
#include "tools/app/budget/gate.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/record/record.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/table/table_files.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

// A run as data of a report: verdict, key figures, facts, and the tables of its folder that charts
// are drawn from. Everything is taken from the files of a run folder, whether they have been
// written or not; what host and time they were made on is left out.

/// @throws InputError for tables that do not hold what leviosim writes
Json run_json(const RunFolder& run);

// A study of many points as data of a report: the points as a table of what was set and what came
// out of it, curves over one of the settings, and the axes that the scatter begins with.

/// Figures over a setting, a line for each value of another.
struct StudyCurves {
  std::string x;
  std::string series;  ///< empty: one line
  std::vector<std::string> y;
  std::string hint = {};   ///< in place of one about medians
  bool from_zero = true;   ///< where the axes of the figures begin
  std::string names = {};  ///< column that names the values 0, 1, … of x; empty: they are numbers
  std::map<std::string, std::vector<std::size_t>> marks = {};  ///< of a figure, points to look at
};

/// A bar for each row.
struct StudyBars {
  std::string of;  ///< names the rows
  std::vector<std::string> figures;
};

/// What a study found: a box with a mark, as the verdict of a run has.
struct StudyBox {
  std::optional<bool> good;
  std::string mark;
  std::string sentence;
  std::vector<std::string> lines;
};

struct StudyPage {
  std::string title;
  std::vector<StudyBox> boxes = {};
  std::string summary;                              ///< lines below the boxes
  std::vector<std::vector<std::string>> best = {};  ///< a table: titles, then rows; may be empty
  Table points{{}};                                 ///< a row per point
  /// Of the table of points, those with key and title; empty: as the table has them.
  std::vector<Head> columns = {};
  std::optional<StudyCurves> curves = {};
  std::optional<StudyBars> bars = {};
  std::map<std::string, double> limits = {};  ///< column → what it should not exceed
  std::string x;                              ///< of the scatter
  std::string y;
  std::string colour;  ///< setting that colours the points; may be empty
};

/// The data of a page: report_json() without runs.
Json study_report(const StudyPage& page);

// The few figures of a run that anybody asks for first, and where its slowest frame spends its
// time. Verdicts are those of result/verdict.h.

/// A stage in the frame that took longest.
struct WorstFrame {
  int frame = 0;
  double latency_ns = 0;
  std::string stage;  ///< that took most of it; empty if not known
  double stage_ns = 0;
};

/// Where it spends its time; empty if that is not known.
std::string reason_of(const WorstFrame& worst);

/// A figure of the first screen, as text.
struct KeyFigure {
  std::string title;
  std::string value;
  std::string unit;
  std::string note;
  std::optional<double> share = {};  ///< of what there is: of the deadline, of a memory
};

/// Those that the run has.
/// @param protocol  of its accuracy; without one, the error is left out
std::vector<KeyFigure> key_figures(const RunRecord& run, const std::string& protocol);

/// The data of a report: {"format", "version", "title", "runs": [run_json()…]} and, where there are
/// some, "comparisons", "check", "study".
Json report_json(const std::string& title, Json runs);

/// The file. @param data  of report_json()
std::string html_page(const Json& data);

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

/// The data of a page about runs. The others are compared with the first.
/// @param check  may be null
Json runs_report(const std::vector<RunFolder>& runs, const std::vector<RunComparison>& comparisons,
                 const CheckResult* check);

/// How commands that run or replay end: with the page, and what a budget says, if they are asked
/// for.
/// @throws LimitNotMet if a limit is not met
void report_and_check(const RunFolder& run, std::optional<outputs::OutputFile>& page,
                      const std::optional<Gate>& gate, bool say = true);

/// Writes the page, if there is a file for it.
/// @param say  whether to print where it is
void publish_report(std::optional<outputs::OutputFile>& file, const Json& data, bool say = true);

}  // namespace leviosim::tools
