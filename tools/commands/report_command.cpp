// leviosim report: runs as one HTML page, from their folders alone.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "sim/base/error.h"
#include "sim/base/printable.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/comparison/comparability.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/html_report/report_option.h"
#include "tools/app/interactive/interactive_page.h"
#include "tools/app/result/verdict.h"
#include "tools/app/run/max_memory.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

struct ReportOptions {
  std::vector<std::string> runs;
  std::string out;
  std::string allow;
  bool force = false;
  bool interactive = false;
  std::string memory;
};

/// The page that computes, of one recorded run.
void run_interactive(const ReportOptions& options) {
  expect_engine();
  if (options.runs.size() != 1)
    throw InputError(
        fmt::format("report --interactive: {} runs are given; expected one, with --record",
                    options.runs.size()));
  std::optional<outputs::OutputFile> file = claimed_report(
      options.out, options.force, {options.runs.begin(), options.runs.end()}, "--out");
  const std::string page = interactive_page(options.runs.front(), trace_memory(options.memory));
  publish({{file, page, "report"}}, Printout(std::string()));
}

void run(const CLI::App& command, const ReportOptions& options) {
  require(command, "RUN", "one or more run folders");
  require(command, "--out", "the page to write, such as report.html");
  if (options.interactive) return run_interactive(options);
  const Allowed allowed = parse_allowed(options.allow);
  std::optional<outputs::OutputFile> page = claimed_report(
      options.out, options.force, {options.runs.begin(), options.runs.end()}, "--out");
  std::vector<RunFolder> runs;
  for (const std::string& name : options.runs) runs.push_back(read_run_folder(name, true));
  std::vector<RunComparison> comparisons;
  for (std::size_t i = 1; i < runs.size(); ++i)
    comparisons.push_back(
        compare_runs(runs.front().record, runs[i].record,
                     check_comparable(runs.front().record, runs[i].record, allowed)));
  const RunRecord& first = runs.front().record;
  publish_report(page, runs_report(runs, comparisons, nullptr));
  print(Printout(std::string())
            .ending("verdict: " + first.verdicts.text(),
                    {runs.size() > 1 ? fmt::format("leviosim compare {} {}", shell_word(first.name),
                                                   shell_word(runs[1].record.name))
                                     : fmt::format("leviosim whatif {}", shell_word(first.name))}));
}

}  // namespace

Command add_report_command(CLI::App& app, const Arguments&) {
  CLI::App* command =
      app.add_subcommand("report", "Runs as one page for a browser, which works offline");
  const auto options = std::make_shared<ReportOptions>();
  command->add_option("RUN", options->runs, "run folders; each is compared with the first");
  const TextOptions add{*command};
  add("-o,--out", options->out, "FILE.html", "page to write");
  add("--allow", options->allow, "data,frames,profile,seed,size",
      "differences of the input that are intended");
  command->add_flag("--interactive", options->interactive,
                    "a page that computes, of one run with --record: sliders change the chip");
  add_memory_option(*command, options->memory);
  command->add_flag("--force", options->force, "replace that file");
  add_examples(*command, {"leviosim report recorded --out report.html",
                          "leviosim report recorded --interactive --out whatif.html"});
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
