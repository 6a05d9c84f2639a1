// The command `leviosim tune`: its options, its files, and the run that it recommends.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/base/printable.h"
#include "tools/app/budget/gate.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/printout.h"
#include "tools/app/cli/version.h"
#include "tools/app/record/record.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/simulate.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/study.h"
#include "tools/app/study/tune/tune_plan.h"
#include "tools/app/study/tune/tune_report.h"
#include "tools/app/study/tune/tuning.h"

namespace leviosim::tools {
namespace {

/// Answer::manifest: what the points are made from, and what was chosen.
Json manifest_of_plan(const TunePlan& plan, const std::vector<Choice>& choices) {
  Json document;
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

/// A loop with the first variation.
struct ChosenRun {
  RunRequest request;
  RunResult result;
};

/// Runs a point by itself with the variations for screening, whatever the cache holds. @returns
/// what the first gave
ChosenRun run_again(const TunePlan& plan, const TunePoint& point) {
  std::optional<ChosenRun> first;
  for (std::size_t i = 0; i < plan.screening; ++i) {
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
                     const Arguments& command_line) {
  return make_manifest(run_options_of(plan, point), run.request, command_line);
}

void declare(CLI::App& command, TuneOptions& options) { add_tune_options(command, options); }

std::vector<std::filesystem::path> inputs_of(const TuneOptions& options) {
  expect_json_or_budget(options.json, options.gate.budget);
  return out_request(options).inputs;
}

std::string head_of(const TunePlan& plan, std::size_t loops) {
  return fmt::format("leviosim {}: {} on {} with {} cores, {} frames of {}, {} closed loops\n\n",
                     version(), plan.request.profile, printable(plan.options.platform),
                     plan.request.cores, plan.sequence.frames, printable(plan.options.data), loops);
}

std::size_t loops_of(const std::vector<TunePoint>& points) {
  std::size_t loops = 0;
  for (const TunePoint& point : points) loops += point.outcomes.size();
  return loops;
}

Answer answer(const TuneOptions& options, const RunnerOptions& runner,
              const Arguments& command_line) {
  const std::optional<Gate> gate = optional_gate(options.gate, {});
  const TunePlan plan = make_tune_plan(options, runner.progress);
  const std::vector<Point> runs = tune_runs(plan);
  std::vector<TunePoint> points = tune_points(plan, runs, run_outcomes(runs, plan.measure, runner));
  confirm(plan, points,
          [&](const std::vector<Point>& more) { return run_outcomes(more, plan.measure, runner); });
  const std::vector<Choice> all = choices(plan, points);
  const TunePoint* best = chosen(all);
  Answer answer{.parts = {head_of(plan, loops_of(points)) + tune_table(plan, points),
                          choice_text(plan, all), tune_notes(plan)},
                .conclusion = tune_conclusion(all),
                .rows = tune_rows(plan, points),
                .more = choice_json(plan, all),
                .page = tune_page(plan, points, all),
                .is_met = best != nullptr,
                .manifest = manifest_of_plan(plan, all)};
  answer.files = {{"runs.csv", csv_text(answer.rows)}};
  if (best == nullptr) {
    if (gate) answer.parts.emplace_back("no point to check against the budget\n");
    return answer;
  }
  const ChosenRun again = run_again(plan, *best);
  answer.parts[1] += claim_text(plan, *best);
  answer.parts[1] += "run again by itself, it gave the same figures: confirmed\n";
  answer.next = {printable(run_command_text(plan, *best))};
  const Manifest manifest = manifest_of(plan, *best, again, command_line);
  if (gate)
    answer.check = [gate = *gate,
                    record = make_record("the chosen point", manifest, again.result)] {
      return gate.check(record);
    };
  const RunFolder folder = run_folder("chosen", std::make_shared<const RunResult>(again.result),
                                      manifest, platform::to_yaml(again.request.platform));
  answer.write_more = [folder](outputs::OutputFolder& out) {
    write_run_folder(out, folder, "chosen/");
  };
  return answer;
}

const Study kTune{
    "tune",
    "Accuracy and power over the clock, in closed loops; the lowest clock that meets the limits",
    "run",
    {"leviosim tune --data flight --clock 240:370:130 --fps 10,20 --out tuned"},
    Study::Leaves::folder};

}  // namespace

Command add_tune_command(CLI::App& app, const Arguments& words) {
  return add_study<TuneOptions>(app, words, kTune, declare, inputs_of, answer);
}

}  // namespace leviosim::tools
