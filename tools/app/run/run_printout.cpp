#include "tools/app/run/run_printout.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/printable.h"
#include "sim/base/text.h"
#include "tools/app/cli/screen.h"
#include "tools/app/report/run_summary.h"
#include "tools/app/report/tables.h"
#include "tools/app/run/run_session.h"

namespace leviosim::tools {
namespace {

constexpr const char* kAll = "all";

/// Lines of remarks for which stages make room.
constexpr int kMostRemarks = 8;

/// The names in "latency,memory"; none for all.
std::vector<std::string> parse_tables(const std::string& text) {
  std::vector<std::string> valid = table_names();
  std::vector<std::string> names = base::split(text, ',');
  if (names.size() == 1 && names.front() == kAll) return {};
  for (const std::string& name : names)
    if (std::find(valid.begin(), valid.end(), name) == valid.end())
      throw InputError(
          fmt::format("--tables '{}': there is no table '{}'; expected all, or some of {}{}", text,
                      name, fmt::join(valid, ","), base::did_you_mean(name, valid)));
  return names;
}

}  // namespace

void add_print_options(CLI::App& command, RunOptions& options) {
  TextOptions{command}(
      "--tables", options.tables, "NAME,…",
      fmt::format("print tables in place of the summary: all, or some of {}; columns "
                  "that do not fit the terminal are left out, COLUMNS=200 shows more",
                  fmt::join(table_names(), ",")));
  add_json_option(command, options.json);
}

void check_print_options(const RunOptions& options, const std::string& budget) {
  expect_json_or_budget(options.json, budget);
  if (options.tables.empty()) return;
  if (options.json) throw InputError("--tables is for text; expected it without --json");
  parse_tables(options.tables);
}

Printout run_printout(const RunOptions& options, const RunResult& run, const RunRecord& record,
                      const std::string& remarks) {
  const auto lines = [&] {
    const std::string title = heading(options, run);
    const int width = output_width();
    if (!options.tables.empty())
      return Printout(title + remarks + report(run, parse_tables(options.tables), width), false);
    const auto lines_of_remarks = std::count(remarks.begin(), remarks.end(), '\n');
    const int others = static_cast<int>(std::min<std::ptrdiff_t>(lines_of_remarks, kMostRemarks));
    const std::string summary = run_summary(title.substr(0, title.find('\n')), run, width, others);
    return Printout({summary, remarks})
        .ending("", {fmt::format("leviosim {} {}", options.record ? "whatif" : "report",
                                 shell_word(options.out)) +
                     (options.record ? "" : " --out report.html")});
  };
  return printout(options.json, lines, [&] { return record_text(record); });
}

}  // namespace leviosim::tools
