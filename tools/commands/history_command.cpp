// leviosim history: runs over time, by commit, in a file.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <memory>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/printable.h"
#include "tools/app/budget/gate.h"
#include "tools/app/cli/child_programs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/history/history.h"
#include "tools/app/history/history_report.h"
#include "tools/app/html_report/report_option.h"
#include "tools/app/run/record_source.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

constexpr const char* kFile = "history.jsonl";
/// Of a page; each takes some 40 kB of memory.
constexpr std::size_t kMostRuns = 2000;

struct HistoryOptions : RecordOptions {
  std::string action;
  std::string run;
  std::string file = kFile;
  std::string commit;
  std::string branch;
  std::string profile;
  std::string time;
  std::string subject;
  std::string page;
  std::string format;
  GateOptions gate;
};

/// What git says of a commit; empty where there is no repository.
std::string git(std::vector<std::string> words) {
  words.insert(words.begin(), "git");
  return output_of(words);
}

std::int64_t parse_time(const std::string& text) {
  std::int64_t seconds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (error != std::errc() || end != text.data() + text.size() || seconds < 0)
    throw InputError(
        fmt::format("--time '{}': expected seconds since 1970, as git log --format=%ct "
                    "prints them",
                    text));
  return seconds;
}

/// From the options, else from the repository in which the command runs.
Origin origin_of(const HistoryOptions& options) {
  Origin origin{options.commit, options.branch, 0, options.subject};
  if (origin.commit.empty()) origin.commit = git({"rev-parse", "HEAD"});
  const auto is_plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  if (origin.commit.empty())
    throw InputError("history add: no git repository here; expected --commit ID");
  if (origin.commit.size() > 64 ||
      !std::all_of(origin.commit.begin(), origin.commit.end(), is_plain))
    throw InputError(fmt::format("--commit '{}': expected letters and digits", origin.commit));
  if (origin.branch.empty()) origin.branch = git({"rev-parse", "--abbrev-ref", "HEAD"});
  if (origin.subject.empty()) origin.subject = git({"log", "-1", "--format=%s", origin.commit});
  const std::string time =
      options.time.empty() ? git({"log", "-1", "--format=%ct", origin.commit}) : options.time;
  if (time.empty())
    throw InputError(
        fmt::format("history add: git knows no commit {}; expected --time T", origin.commit));
  origin.time_s = parse_time(time);
  return origin;
}

LimitsThen limits_of(const PastRun& run, Gate gate, const History& history) {
  // The run before is the baseline, unless there is another; of the first run, itself.
  const std::vector<PastRun> before = history.like(run.record, run.origin.branch, 1);
  gate.use_baseline(before.empty() ? run.record : before.back().record);
  const CheckResult check = gate.check(run.record);
  LimitsThen limits{check.findings.size(), {}};
  for (const Finding& finding : check.findings)
    if (finding.fails()) limits.missed.push_back(finding.title());
  return limits;
}

void add(const CLI::App& command, const HistoryOptions& options) {
  require(command, "RUN", "a run folder or a work trace");
  std::optional<Gate> gate = optional_gate(options.gate, options);
  PastRun run{origin_of(options), {}, read_run_or_baseline(options.run, options)};
  std::size_t runs = 0;
  bool is_new = false;
  add_to_history(options.file, [&](const History& history) {
    if (gate) run.limits = limits_of(run, *gate, history);
    const std::string lines = history.line_for(run);
    runs = history.size();
    is_new = !lines.empty();
    return lines;
  });
  const std::string place = is_new
                                ? fmt::format("is run {} of {}", runs + 1, printable(options.file))
                                : fmt::format("is in {} already", printable(options.file));
  const std::string limits =
      gate ? fmt::format("; {} of {} limits not met", run.limits.missed.size(), run.limits.held)
           : "";
  print(
      Printout(std::string())
          .ending(fmt::format("in short: {} {}{}", short_commit(run.origin.commit), place, limits),
                  {fmt::format("leviosim history show --file {}", shell_word(options.file))}));
}

/// Runs like the newest of the branch and the profile.
std::vector<PastRun> newest(const HistoryOptions& options, std::size_t most) {
  const History history = History::read(options.file);
  for (std::size_t i = history.size(); i > 0; --i) {
    const PastRun run = history.run(i - 1);
    if ((options.branch.empty() || run.origin.branch == options.branch) &&
        (options.profile.empty() || run.record.facts.profile == options.profile))
      return history.like(run.record, options.branch, most);
  }
  throw InputError(fmt::format("{}: has no runs{}{}; expected some of 'leviosim history add'",
                               options.file, options.branch.empty() ? "" : " of " + options.branch,
                               options.profile.empty() ? "" : " of " + options.profile));
}

std::optional<Budget> budget_of(const HistoryOptions& options) {
  if (options.gate.budget.empty()) return std::nullopt;
  return read_budget(options.gate.budget);
}

void show(const HistoryOptions& options) {
  constexpr std::size_t kShown = 200;
  const std::optional<Budget> budget = budget_of(options);
  const std::vector<PastRun> runs = newest(options, kShown);
  if (!options.format.empty()) return print(Printout(exported(runs.back(), options.format), true));
  print(printout(
      options.json,
      [&] {
        return history_printout(runs, budget ? &*budget : nullptr,
                                {fmt::format("leviosim history page --file {} --out trend.html",
                                             shell_word(options.file))});
      },
      [&] { return history_document(runs); }));
}

void page(const CLI::App& command, const HistoryOptions& options) {
  require(command, "--out", "the page to write, such as trend.html");
  const std::optional<Budget> budget = budget_of(options);
  std::optional<outputs::OutputFile> file =
      claimed_report(options.page, options.force, {options.file}, "--out");
  const std::vector<PastRun> runs = newest(options, kMostRuns);
  const RunFacts& facts = runs.back().record.facts;
  const std::string which =
      runs.size() == kMostRuns ? fmt::format("the newest {} commits", kMostRuns) : "commits";
  publish_report(file,
                 history_page(fmt::format("{} on {} over {}", facts.profile, facts.platform, which),
                              runs, budget ? &*budget : nullptr));
  print(history_printout(runs, budget ? &*budget : nullptr, {}));
}

void run(const CLI::App& command, const HistoryOptions& options) {
  require(command, "ACTION", "add, show or page");
  const std::vector<std::string> actions{"add", "show", "page"};
  if (options.action == "add") return add(command, options);
  if (command.count("RUN") > 0)
    throw InputError(
        fmt::format("history {}: takes no run; leave out {}", options.action, options.run));
  if (options.action == "show") return show(options);
  if (options.action == "page") return page(command, options);
  throw InputError(fmt::format("history: unknown action '{}'; expected add, show or page{}",
                               options.action, base::did_you_mean(options.action, actions)));
}

}  // namespace

Command add_history_command(CLI::App& app, const Arguments&) {
  CLI::App* command =
      app.add_subcommand("history", "Keep runs by commit in a file, and show how figures moved");
  const auto options = std::make_shared<HistoryOptions>();
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    command->add_option(name, value, help)->type_name(type);
  };
  command->add_option("ACTION", options->action,
                      "add: a run to the file; show: the newest; page: charts over commits");
  command->add_option(
      "RUN", options->run,
      "add: run folder, work trace to replay, baseline, or CSV file of measured cycles");
  add("--file", options->file, "FILE", "file of the history [history.jsonl]");
  add("--commit", options->commit, "ID", "commit of the run [git: HEAD]");
  add("--branch", options->branch, "NAME",
      "branch of the run [git]; show, page: only runs of it [all]");
  add("--profile", options->profile, "NAME",
      "show, page: only runs of this profile [that of the newest run]");
  add("--time", options->time, "S", "time of the commit, in seconds since 1970 [git]");
  add("--subject", options->subject, "TEXT", "subject line of the commit's message [git]");
  add("-o,--out", options->page, "FILE.html", "page: file to write");
  add("--export", options->format, "github-action-benchmark|bencher",
      "show: the newest run in the format of these trackers");
  add_gate_options(*command, options->gate);
  command->add_flag("--force", options->force, "page: replace the file");
  add_json_option(*command, options->json);
  add_record_options(*command, *options);
  add_examples(*command,
               {"leviosim history add recorded --commit 4f1c2aa --branch main --time 1764133200",
                "leviosim history show", "leviosim history page --out trend.html"});
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
