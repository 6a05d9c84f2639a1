#include "tools/commands/tune_command.h"

#include <fmt/core.h>

#include <memory>

#include "sim/base/error.h"
#include "sim/base/printable_text.h"
#include "tools/app/cli/interrupts.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/version.h"
#include "tools/app/report/table_document.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/simulate.h"
#include "tools/app/study/tune/tune_plot.h"
#include "tools/app/study/tune/tune_report.h"

namespace leviosim::tools {
namespace {

/// Runs a point by itself with all seeds, whatever the cache holds. @returns what the first gave
RunResult run_again(const TunePlan& plan, const TunePoint& point) {
  std::vector<RunResult> results;
  for (std::size_t i = 0; i < plan.seeds.size(); ++i) {
    results.push_back(simulate(request_of(plan, point.fps, point.setting, plan.seeds[i]),
                               [](const Progress&) { throw_if_interrupted(); }));
    const RunOutcome outcome = outcome_of(results.back(), plan.sequence.truth, plan.measure);
    if (to_text(figures_of(outcome)) != to_text(figures_of(point.outcomes[i])))
      throw InputError(
          "tune: run again, the chosen point gave other figures than were found in the cache of "
          "finished runs; remove it, or choose another with --cache");
  }
  return std::move(results.front());
}

void write_chosen(const TunePlan& plan, const TunePoint& point, const RunResult& result,
                  const Words& command_line) {
  const RunRequest request = request_of(plan, point.fps, point.setting, plan.seeds.front());
  write_run_folder(*plan.out, result,
                   make_manifest(run_options_of(plan, point), request, command_line),
                   platform::to_yaml(request.platform), "chosen/");
}

void write_folder(const TunePlan& plan, const std::vector<TunePoint>& points,
                  const std::optional<RunResult>& again, const Words& command_line) {
  const std::vector<Choice> all = choices(plan, points);
  plan.out->write("runs.csv", tune_csv(plan, points));
  plan.out->write("tune.svg", tune_plot(plan, points, all));
  if (again) write_chosen(plan, *chosen(all), *again, command_line);
  plan.out->write("manifest.json", json_text(tune_manifest(plan, all, command_line), 2) + '\n');
}

void run(const CLI::App& command, const TuneWords& words, const Words& command_line) {
  const TunePlan plan = make_tune_plan(command, words);
  const std::vector<Point> runs = tune_runs(plan);
  const std::vector<TunePoint> points =
      tune_points(plan, runs, run_outcomes(runs, plan.measure, plan.runner));
  const std::vector<Choice> all = choices(plan, points);
  const TunePoint* best = chosen(all);
  std::optional<RunResult> again;
  if (best != nullptr) again = run_again(plan, *best);
  std::string text =
      fmt::format("leviosim {}: {} on {} with {} cores, {} frames of {}, {} closed loops\n\n{}\n{}",
                  version(), plan.request.profile, printable(plan.options.platform),
                  plan.request.cores, plan.sequence.frames, printable(plan.options.data),
                  runs.size(), tune_table(plan, points), choice_text(plan, all));
  if (again) text += "run again by itself, it gave the same figures: confirmed\n";
  const Printout shown = printout(
      words.run.json, [&] { return text; },
      [&] { return table_document("tuning", tune_csv(plan, points)); });
  if (plan.out)
    publish(*plan.out, shown, [&] { write_folder(plan, points, again, command_line); });
  else
    print(shown);
}

}  // namespace

Command add_tune_command(CLI::App& app, const Words& words) {
  CLI::App* command = app.add_subcommand(
      "tune",
      "Accuracy and power over the clock, in closed loops; the lowest clock that meets the limits");
  const auto typed = std::make_shared<TuneWords>();
  add_tune_options(*command, *typed);
  add_json_option(*command, typed->run.json);
  return {command, [=, &words] { run(*command, *typed, words); }};
}

}  // namespace leviosim::tools
