// leviosim compare: what differs between runs, and why.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "sim/base/error.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/comparison/comparability.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/comparison/comparison_report.h"
#include "tools/app/comparison/two_programs.h"
#include "tools/app/html_report/page.h"
#include "tools/app/html_report/report_option.h"
#include "tools/app/record/measured.h"
#include "tools/app/run/record_source.h"
#include "tools/app/study/sweep/point_name.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

struct CompareOptions : RecordOptions {
  std::vector<std::string> runs;
  std::vector<std::string> programs;
  std::string allow;
  std::string format = "text";
  bool json = false;
  bool all = false;
  std::string report;
};

/// ", gap8, cluster.fpu.units=1": where all runs are timed.
std::string on_chip(const CompareOptions& options) {
  std::string text;
  if (!options.platform.empty()) text += ", " + options.platform;
  for (const std::string& assignment : options.overrides) text += ", " + assignment;
  if (!options.cores.empty()) text += fmt::format(", {} cores", options.cores);
  return text;
}

RunFolder named_run(const std::string& run, const CompareOptions& options) {
  const std::optional<PointName> point = point_name(run);
  if (point && options.names_chip())
    throw InputError(fmt::format(
        "{}: a point of a sweep has its chip; leave out --platform, -p and --cores", run));
  RunFolder result =
      point ? read_point(*point, options) : read_run(run, options, !options.report.empty());
  if (options.names_chip() && options.runs.size() > 1) result.record.name += on_chip(options);
  return result;
}

/// All runs that are compared with the first. One run with a chip is compared with itself there.
std::vector<RunFolder> records(const CompareOptions& options) {
  std::vector<RunFolder> list;
  if (options.runs.size() == 1) {
    if (!options.names_chip())
      throw InputError(fmt::format(
          "compare: only {} is given; expected two runs, or one with a recorded trace and the chip "
          "to compare it on: --platform, -p",
          options.runs.front()));
    RecordOptions as_recorded = options;
    as_recorded.platform.clear();
    as_recorded.overrides.clear();
    as_recorded.cores.clear();
    const std::string trace = trace_of(options.runs.front());
    if (trace.empty()) {
      list.push_back(named_run(options.runs.front(), options));
    } else {
      list.push_back(replayed_run(trace, as_recorded));
    }
  }
  for (const std::string& run : options.runs) list.push_back(named_run(run, options));
  return list;
}

/// Two builds on the same input: their runs, by the names of the builds.
/// @param note  gets what of the difference is work, cost and chip
std::vector<RunFolder> runs_of_programs(const CompareOptions& options, std::string& note) {
  if (options.names_chip())
    throw InputError(
        "compare: with --programs the chip stands behind --, as the other arguments of leviosim "
        "run");
  const TwoPrograms programs(options.programs, options.runs);
  std::vector<RunFolder> list;
  for (std::size_t i = 0; i < programs.folders().size(); ++i) {
    list.push_back(read_run_folder(programs.folders()[i], !options.report.empty()));
    list.back().record.name = options.programs[i];
  }
  note = programs.split();
  return list;
}

/// One run on two chips: columns of a page are named by the change, since the run has one name.
void name_by_change(std::vector<RunFolder>& runs, const CompareOptions& options) {
  constexpr std::size_t kComma = 2;
  if (options.runs.size() != 1 || runs.size() != 2) return;
  runs.front().record.name = "as recorded";
  runs.back().record.name = on_chip(options).substr(kComma);
}

void run(const CLI::App& command, const CompareOptions& options) {
  require(
      command, "RUN",
      options.programs.empty()
          ? "two or more run folders, work traces or points of sweeps (SWEEP:3)"
          : "behind -- the arguments of leviosim run, such as -- --platform gap9 --data flight");
  if (options.json && command.count("--format") > 0)
    throw InputError("compare: --json is --format json; leave out one");
  const ReportFormat format =
      options.json ? ReportFormat::json : parse_report_format(options.format);
  const Allowed allowed = parse_allowed(options.allow);
  if (format == ReportFormat::csv && options.runs.size() > 2)
    throw InputError("compare: --format csv is for two runs; expected text, markdown or json");
  std::optional<outputs::OutputFile> page =
      claimed_report(options.report, options.force, {options.runs.begin(), options.runs.end()});
  std::string note;
  std::vector<RunFolder> runs =
      options.programs.empty() ? records(options) : runs_of_programs(options, note);
  for (const RunFolder& run : runs)
    if (page && run.record.facts.measured)
      throw InputError(
          fmt::format("{}: was measured, so it has no page; leave out --report", run.record.name));
  for (const RunFolder& run : runs)
    if (!run.record.facts.measured)
      for (RunFolder& other : runs) name_stages_like(other.record, run.record);
  std::vector<RunComparison> comparisons;
  for (std::size_t i = 1; i < runs.size(); ++i)
    comparisons.push_back(
        compare_runs(runs.front().record, runs[i].record,
                     check_comparable(runs.front().record, runs[i].record, allowed)));
  if (!note.empty()) comparisons.front().notes.push_back(note);
  const std::string text = comparison_report(comparisons, format, options.all);
  std::string html;
  if (page) {
    name_by_change(runs, options);
    html = html_page(runs_report(runs, comparisons, nullptr));
  }
  publish({{page, html, ""}}, format == ReportFormat::text ? Printout(text) : Printout(text, true));
}

}  // namespace

Command add_compare_command(CLI::App& app, const Arguments&) {
  CLI::App* command =
      app.add_subcommand("compare", "Show what differs between runs, and why, by mechanism");
  const auto options = std::make_shared<CompareOptions>();
  command->add_option(
      "RUN", options->runs,
      "run folders, work traces, points of sweeps (SWEEP:3), or CSV files of measured "
      "cycles; each against the first");
  command
      ->add_option("--programs", options->programs,
                   "two builds of leviosim that are compared on what stands behind --: arguments "
                   "of leviosim run")
      ->type_name("OLD NEW")
      ->type_size(2)  // with expected(2), CLI11 would take the -- for its end
      ->expected(1)
      ->allow_extra_args(false);
  const TextOptions add{*command};
  add("--allow", options->allow, "data,frames,profile,seed,size",
      "differences of the input that are intended");
  add("--format", options->format, "FORMAT", "text, markdown, json or csv [text]");
  command->add_flag("--all", options->all, "all tables in place of the summary");
  add_json_option(*command, options->json);
  add_report_option(*command, options->report);
  command->add_flag("--force", options->force, "replace that file");
  add_record_options(*command, *options);
  add_examples(*command, {"leviosim compare recorded one-fpu",
                          "leviosim compare recorded -p cluster.fpu.dividers=2 --format markdown",
                          "leviosim compare swept:1 swept:3"});
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
