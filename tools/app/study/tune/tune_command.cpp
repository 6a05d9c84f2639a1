#include "tools/app/study/tune/tune_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/base/printable.h"
#include "tools/app/budget/gate.h"
#include "tools/app/cli/exit_status.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/cli/version.h"
#include "tools/app/html_report/report_option.h"
#include "tools/app/record/record.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/simulate.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/batch_plan.h"
#include "tools/app/study/tune/tune_plan.h"
#include "tools/app/study/tune/tune_report.h"
#include "tools/app/study/tune/tuning.h"

namespace leviosim::tools {
namespace {

/// The content of manifest.json. Nothing in it depends on the host or on cache hits.
Json tune_manifest(const TunePlan& plan, const std::vector<Choice>& choices,
                   const Words& command_line) {
  Json document = study_manifest("leviosim tune manifest", command_line);
  document["profile"] = plan.request.profile;
  document["seeds"] = Json::array();
  document["variations"] = Json::array();
  for (const Variation& variation : plan.variations) {
    if (!plan.perturbs) document["seeds"].push_back(variation.seed);
    document["variations"].push_back(variation.name);
  }
  document["platform"]["name"] = plan.options.platform;
  document["platform"]["cores"] = plan.request.cores;
  document["deadline"] = info_of(plan.deadline).name;
  document["miss_rate"] = plan.miss_rate;
  document["ate_m"] = plan.ate_m;
  document["sequence"] = {{"folder", plan.sequence.folder},
                          {"frames", plan.sequence.frames},
                          {"recorded_fps", plan.recorded_hz},
                          {"inputs_sha256", plan.sequence.inputs}};
  document.update(choice_json(plan, choices));
  return document;
}

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
    if (record_json(record_of(outcome)) != record_json(record_of(point.outcomes[i])))
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
  plan.out->write("runs.csv", csv_text(tune_rows(plan, points)));
  if (again)
    write_run_folder(
        *plan.out,
        run_folder("chosen", again->result, manifest_of(plan, *chosen(all), *again, command_line),
                   platform::to_yaml(again->request.platform)),
        "chosen/");
  plan.out->write("manifest.json", json_text(tune_manifest(plan, all, command_line), 2) + '\n');
}

/// Holds the chosen point against the budget, with the first variation.
void hold(const Gate& gate, const TunePlan& plan, const TunePoint* best,
          const std::optional<ChosenRun>& again, const Words& command_line) {
  if (!again) {
    print(Printout("no point to check against the budget\n"));
    throw LimitNotMet();
  }
  print_check(gate.check(make_record(
      "the chosen point", manifest_of(plan, *best, *again, command_line), again->result)));
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
    const std::string head = fmt::format(
        "leviosim {}: {} on {} with {} cores, {} frames of {}, {} closed loops\n\n", version(),
        plan.request.profile, printable(plan.options.platform), plan.request.cores,
        plan.sequence.frames, printable(plan.options.data), runs.size());
    std::string choice = choice_text(plan, all);
    if (again) choice += "run again by itself, it gave the same figures: confirmed\n";
    std::vector<std::string> next;
    if (best != nullptr) next.push_back(printable(run_command_text(plan, *best)));
    return Printout({head + tune_table(plan, points), tune_notes(plan), choice})
        .ending(tune_conclusion(all), next);
  };
  const Printout shown = printout(words.run.json, lines, [&] {
    return table_document("tuning", tune_rows(plan, points), choice_json(plan, all));
  });
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
  return {.app = command, .run = [=, &words] { run(*command, *typed, words); }, .goes_on = true};
}

}  // namespace leviosim::tools
