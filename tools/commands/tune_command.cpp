// `leviosim tune`: closed loops over clock and frame rate. Its folder:
//
//   manifest.json   what the batch was made from, and what was chosen
//   runs.csv        a row per point and seed
//   tune.svg        error, missed frames and power over the clock
//   chosen/         the run folder of the lowest clock that is enough, with the first seed, run
//   again
#include "tools/commands/commands.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "sim/base/error.h"
#include "sim/base/printable_text.h"
#include "tools/app/budget/gate.h"
#include "tools/app/cli/interrupts.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/version.h"
#include "tools/app/comparison/cycle_parts.h"
#include "tools/app/html_report/report_file.h"
#include "tools/app/report/table_document.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/simulate.h"
#include "tools/app/study/tune/tune_plot.h"
#include "tools/app/study/tune/tune_report.h"

namespace leviosim::tools {
namespace {

struct GatedTuneWords : TuneWords {
  GateOptions gate;
  std::string report;
};

/// A loop with the first variation.
struct ChosenRun {
  RunRequest request;
  RunResult result;
};

/// Runs a point by itself with all variations, whatever the cache holds. @returns what the first
/// gave
ChosenRun run_again(const TunePlan& plan, const TunePoint& point) {
  std::optional<ChosenRun> first;
  for (std::size_t i = 0; i < plan.variations.size(); ++i) {
    RunRequest request = request_of(plan, point.fps, point.setting, plan.variations[i]);
    if (i == 0) request.time_bands = TimeBandsOf::team;  // as in the folder of a run
    RunResult result = simulate(request, [](const Progress&) { throw_if_interrupted(); });
    const RunOutcome outcome = outcome_of(result, plan.sequence.truth, plan.measure);
    if (to_text(figures_of(outcome)) != to_text(figures_of(point.outcomes[i])))
      throw InputError(
          "tune: run again, the chosen point gave other figures than were found in the cache of "
          "finished runs; remove it, or choose another with --cache");
    if (i == 0) first = ChosenRun{std::move(request), std::move(result)};
  }
  return std::move(*first);
}

Manifest manifest_of(const TunePlan& plan, const TunePoint& point, const ChosenRun& run,
                     const Words& command_line) {
  return make_manifest(run_options_of(plan, point), run.request, command_line);
}

void write_folder(const TunePlan& plan, const std::vector<TunePoint>& points,
                  const std::optional<ChosenRun>& again, const Words& command_line) {
  const std::vector<Choice> all = choices(plan, points);
  plan.out->write("runs.csv", tune_csv(plan, points));
  plan.out->write("tune.svg", tune_plot(plan, points, all));
  if (again)
    write_run_folder(*plan.out, again->result,
                     manifest_of(plan, *chosen(all), *again, command_line),
                     platform::to_yaml(again->request.platform), "chosen/");
  plan.out->write("manifest.json", json_text(tune_manifest(plan, all, command_line), 2) + '\n');
}

/// Holds the chosen point against the budget, with the first variation.
void hold(const Gate& gate, const TunePlan& plan, const TunePoint* best,
          const std::optional<ChosenRun>& again, const Words& command_line) {
  if (!again) {
    print(Printout("no point to hold against the budget\n"));
    throw LimitNotMet();
  }
  print_check(
      gate.check(make_record("the chosen point", manifest_of(plan, *best, *again, command_line),
                             again->result, cycle_parts(again->result))));
}

void run(const CLI::App& command, const GatedTuneWords& words, const Words& command_line) {
  expect_json_or_budget(words.run.json, words.gate.budget);
  const std::optional<Gate> gate = optional_gate(words.gate, {});
  std::optional<outputs::OutputFile> page = claimed_report(words.report, words.run.force);
  const TunePlan plan = make_tune_plan(command, words);
  const std::vector<Point> runs = tune_runs(plan);
  const std::vector<TunePoint> points =
      tune_points(plan, runs, run_outcomes(runs, plan.measure, plan.runner));
  const std::vector<Choice> all = choices(plan, points);
  const TunePoint* best = chosen(all);
  std::optional<ChosenRun> again;
  if (best != nullptr) again = run_again(plan, *best);
  const auto lines = [&] {
    const std::string head =
        fmt::format("leviosim {}: {} on {} with {} cores, {} frames of {}, {} closed loops\n\n",
                    version(), plan.request.profile, printable(plan.options.platform),
                    plan.request.cores, plan.sequence.frames, printable(plan.options.data),
                    runs.size());
    std::string choice = choice_text(plan, all);
    if (again) choice += "run again by itself, it gave the same figures: confirmed\n";
    std::vector<std::string> next;
    if (best != nullptr) next.push_back(printable(run_command_text(plan, *best)));
    return Printout({head + tune_table(plan, points), tune_notes(plan), choice})
        .ending(tune_conclusion(all), next);
  };
  const Printout shown = printout(
      words.run.json, lines,
      [&] { return table_document("tuning", tune_csv(plan, points), choice_json(plan, all)); });
  if (plan.out)
    publish(*plan.out, shown, [&] { write_folder(plan, points, again, command_line); });
  else
    print(shown);
  if (page) publish_report(page, tune_page(plan, points, all), !words.run.json);
  if (gate) hold(*gate, plan, best, again, command_line);
  if (best == nullptr) throw LimitNotMet();
}

}  // namespace

Command add_tune_command(CLI::App& app, const Words& words) {
  CLI::App* command = app.add_subcommand(
      "tune",
      "Accuracy and power over the clock, in closed loops; the lowest clock that meets the limits");
  const auto typed = std::make_shared<GatedTuneWords>();
  add_tune_options(*command, *typed);
  add_report_option(*command, typed->report);
  add_gate_options(*command, typed->gate);
  add_json_option(*command, typed->run.json);
  add_examples(*command,
               {"leviosim tune --data flight --clock 240:370:130 --fps 10,20 --out tuned"});
  return {command, [=, &words] { run(*command, *typed, words); }};
}

}  // namespace leviosim::tools
