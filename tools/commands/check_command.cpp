// leviosim check: checks a run against a budget.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "sim/base/error.h"
#include "sim/base/printable.h"
#include "tools/app/budget/check.h"
#include "tools/app/budget/check_for_ci.h"
#include "tools/app/budget/check_report.h"
#include "tools/app/budget/gate.h"
#include "tools/app/cli/child_programs.h"
#include "tools/app/cli/exit_status.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/history/history.h"
#include "tools/app/history/trends.h"
#include "tools/app/html_report/page.h"
#include "tools/app/html_report/report_option.h"
#include "tools/app/record/measured.h"
#include "tools/app/run/record_source.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

/// Drift over more runs is a matter of a new baseline.
constexpr std::size_t kRunsBefore = 200;

struct CheckOptions : RecordOptions {
  std::string run;
  GateOptions gate;
  std::string junit;
  std::string annotations;
  std::string report;
  std::string markdown;
  std::string history;
  std::string branch;
  std::string commit;
  bool json = false;
};

void check_options(const CLI::App& command, const CheckOptions& options) {
  require(command, "RUN", "a run folder or a work trace");
  require(command, "--budget", "a file with limits (leviosim budget init writes a first one)");
  if (!options.annotations.empty() && options.annotations != "github" &&
      options.annotations != "gitlab")
    throw InputError(
        fmt::format("--annotations '{}': expected github or gitlab", options.annotations));
  if (options.json && !options.annotations.empty())
    throw InputError("check: --json and --annotations both print to stdout; leave out one");
}

/// The page says more about what is not met.
Printout text_report(const CheckOptions& options, const CheckResult& result) {
  if (options.annotations == "gitlab") return Printout(gitlab_report(result), true);
  if (is_measured(options.run) && !options.gate.baseline.empty())
    return check_printout(result, {fmt::format("leviosim compare {} {}", shell_word(options.run),
                                               shell_word(options.gate.baseline))});
  std::string page = fmt::format("leviosim check {} --budget {}", shell_word(options.run),
                                 shell_word(options.gate.budget));
  if (!options.gate.baseline.empty()) page += " --baseline " + shell_word(options.gate.baseline);
  for (const std::string& set : options.overrides) page += " -p " + shell_word(set);
  return check_printout(result, {page + " --report check.html"});
}

/// Runs like this one before its commit: a check that is run again compares with what it did.
std::vector<PastRun> runs_before(const History& history, const RunRecord& record,
                                 const CheckOptions& options) {
  std::vector<PastRun> before = history.like(record, options.branch, kRunsBefore);
  const std::string commit =
      options.commit.empty() ? output_of({"git", "rev-parse", "HEAD"}) : options.commit;
  std::erase_if(before, [&](const PastRun& run) { return run.origin.commit == commit; });
  return before;
}

/// The same work on the chip of its recording, which explains a miss on another one.
std::optional<RunRecord> recorded_chip(const CheckOptions& options, const CheckResult& result) {
  const std::string trace = trace_of(options.run);
  const bool explains = result.baseline.empty() && result.missed() + result.warned() > 0;
  if (!explains || trace.empty() || !options.names_chip()) return std::nullopt;
  RecordOptions recorded = options;
  recorded.platform.clear();
  recorded.overrides.clear();
  recorded.cores.clear();
  return read_record(trace, recorded);
}

void run(const CLI::App& command, const CheckOptions& options) {
  check_options(command, options);
  std::optional<History> history;
  if (!options.history.empty()) history = History::read(options.history);
  Gate gate(options.gate, options);
  std::optional<outputs::OutputFile> junit =
      claimed_file({.option = "--junit",
                    .path = options.junit,
                    .replace = options.force,
                    .inputs = {options.run, options.gate.budget, options.gate.baseline}});
  std::optional<outputs::OutputFile> page = claimed_report(
      options.report, options.force, {options.run, options.gate.budget, options.gate.baseline});
  expect_different(junit, "--junit", page, "--report");
  std::optional<outputs::OutputFile> comment =
      claimed_file({.option = "--markdown",
                    .path = options.markdown,
                    .replace = options.force,
                    .inputs = {options.run, options.gate.budget, options.gate.baseline}});
  expect_different(junit, "--junit", comment, "--markdown");
  const RunFolder run = read_run(options.run, options, page.has_value());
  const RunRecord& record = run.record;
  if (page && record.facts.measured)
    throw InputError(
        fmt::format("{}: was measured, so it has no page; leave out --report", options.run));
  std::vector<PastRun> before;
  if (history) before = runs_before(*history, record, options);
  if (!before.empty()) gate.use_baseline(before.back().record);
  CheckResult result = gate.check(record);
  if (const auto recorded = recorded_chip(options, result)) result = gate.check(record, &*recorded);
  add_history(result, record, gate.budget(), before);
  std::string html;
  if (page) html = html_page(runs_report({run}, {}, &result));
  Printout report = printout(
      options.json, [&] { return text_report(options, result); },
      [&] { return json_text(check_json(result), 2) + '\n'; });
  if (options.annotations == "github") report.ci_commands = github_annotations(result);
  publish({{junit, junit_xml(result), ""},
           {comment, comment ? markdown_comment(result, record, gate.baseline()) : "", ""},
           {page, html, ""}},
          report);
  if (result.missed() > 0) throw LimitNotMet();
}

}  // namespace

Command add_check_command(CLI::App& app, const Arguments&) {
  CLI::App* command =
      app.add_subcommand("check", "Check a run against a budget; status 1 if a limit is not met");
  const auto options = std::make_shared<CheckOptions>();
  command->add_option("RUN", options->run,
                      "run folder, work trace to replay, or CSV file of measured cycles");
  add_gate_options(*command, options->gate);
  const TextOptions add{*command};
  add("--junit", options->junit, "FILE", "report for CI servers to write");
  add("--markdown", options->markdown, "FILE.md",
      "comment for a pull request, or the summary of a job, to write");
  add("--history", options->history, "FILE",
      "earlier runs (leviosim history add): the last one is the baseline if --baseline names "
      "none, and slow drift over them is found");
  add("--branch", options->branch, "NAME", "branch of the history [all]");
  add("--commit", options->commit, "ID",
      "commit of the run, which the history leaves out [git: HEAD]");
  add_report_option(*command, options->report);
  command->add_flag("--force", options->force, "replace these files");
  add("--annotations", options->annotations, "github|gitlab",
      "github: lines that mark the limits; gitlab: a code quality report on stdout");
  add_json_option(*command, options->json);
  add_record_options(*command, *options);
  add_examples(*command, {"leviosim budget init recorded >budgets.yaml",
                          "leviosim check recorded --budget budgets.yaml --junit junit.xml"});
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
