// The command `leviosim ablate`: its options, and what it leaves.
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <limits>

#include "sim/base/error.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/version.h"
#include "tools/app/study/ablate/ablation.h"
#include "tools/app/study/ablate/ablation_table.h"
#include "tools/app/study/ablate/dimensions.h"
#include "tools/app/study/ablate/published_accuracy.h"
#include "tools/app/study/finished_runs.h"
#include "tools/app/study/study.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr std::int64_t kMostSampled = 1'000'000;

struct AblateOptions : BatchOptions {
  std::vector<std::string> vary;
  std::string points = "40";
  std::string sample_seed = "1";
};

void declare(CLI::App& command, AblateOptions& options) {
  add_batch_options(command, options);
  const TextOptions add{command};
  add("--vary", options.vary, "NAME=LOW:HIGH",
      "parameter to draw from a range, off and on if it is a switch, or paper: the five that the "
      "paper varies; repeatable [profiles as they are]");
  add("--points", options.points, "N", "with --vary: points of each profile, itself first [40]");
  add("--sample-seed", options.sample_seed, "N", "with --vary: of the points' random draws [1]");
}

Ablation make_ablation(const AblateOptions& options, ProgressLine::Style progress) {
  Ablation ablation;
  ablation.dimensions = parse_dimensions(options.vary);
  const auto count = parse_whole("--points", options.points, 1, kMostSampled);
  const auto seed = parse_whole("--sample-seed", options.sample_seed, 0,
                                std::numeric_limits<std::int64_t>::max());
  if (!ablation.dimensions.empty())
    ablation.points = sample_points(ablation.dimensions, static_cast<std::size_t>(count),
                                    static_cast<std::uint64_t>(seed));
  ablation.plan = make_plan(options, progress);
  for (const vio::Assignment& a : ablation.plan.workload)
    for (const Dimension& d : ablation.dimensions)
      if (a.parameter == d.parameter)
        throw InputError(fmt::format("-p {}: is varied; choose what is with --vary", a.text()));
  return ablation;
}

Json manifest_of(const Ablation& ablation, const AblateOptions& options) {
  Json manifest = batch_manifest(ablation.plan);
  if (ablation.dimensions.empty()) return manifest;
  manifest["points"] = ablation.points.size();
  manifest["sample_seed"] = options.sample_seed;
  for (const Dimension& d : ablation.dimensions)
    manifest["dimensions"].push_back({{"name", d.parameter->name},
                                      {"low", vio::value_text(*d.parameter, d.low)},
                                      {"high", vio::value_text(*d.parameter, d.high)},
                                      {"unit", d.parameter->unit}});
  return manifest;
}

/// Point and dimensions of every run, for run_rows(). @param ablation  outlives the columns
RunColumns point_columns(const Ablation& ablation) {
  using R = const FinishedRun&;
  if (ablation.dimensions.empty()) return {};
  RunColumns columns{
      {{.key = "point"}, [count = ablation.points.size()](R r) { return r.point.row % count; }}};
  for (const Dimension& d : ablation.dimensions)
    columns.push_back({{.key = std::string(d.parameter->name)}, [&d](R r) {
                         const RunRequest& request = r.point.request;
                         return spelled(value_in(d, request.profile, request.workload));
                       }});
  return columns;
}

Answer answer(const AblateOptions& options, const RunnerOptions& runner, const Arguments&) {
  const Ablation ablation = make_ablation(options, runner.progress);
  const std::vector<Point> runs = ablation_runs(ablation);
  const std::vector<RunOutcome> outcomes = run_outcomes(runs, ablation.plan.measure, runner);
  const std::vector<AblationRow> rows =
      ablation_rows(ablation, runs, outcomes, published_accuracy());
  const Table shown = ablation_table(ablation, notable_rows(ablation, rows));
  Answer answer{.parts = {fmt::format("leviosim {}: {} native runs\n{}{}", version(), runs.size(),
                                      terminal_text(shown), ablation_notes(ablation, rows, "  ")),
                          accuracy_comparison(ablation, rows, published_accuracy())},
                .conclusion = ablation_conclusion(ablation, rows),
                .next = after_batch(ablation.plan),
                .rows = ablation_table(ablation, rows),
                .page = ablation_page(ablation, rows),
                .manifest = manifest_of(ablation, options)};
  answer.more["measure"] = measure_text(ablation.plan.measure);
  const Table all = run_rows(runs, outcomes, ablation.plan.measure, point_columns(ablation));
  answer.files = {
      {"runs.csv", csv_text(all)},
      {"rows.csv", csv_text(answer.rows)},
      {"table.md", markdown_table(shown) + '\n' + ablation_notes(ablation, rows, "- ")}};
  return answer;
}

const Study kAblate{
    "ablate",
    "Accuracy of profiles, image sizes and parameters over sequences: the paper's table and sweep",
    "run",
    {"leviosim ablate --data flight --profile levio,next --size 160x120,320x240 --seed 1 "
     "--relative 0.5 --out ablated",
     "leviosim ablate --data flight --profile levio --vary workload.window=6:12 --points 3 "
     "--seed 1 --relative 0.5 --out varied"},
    Study::Leaves::folder};

}  // namespace

Command add_ablate_command(CLI::App& app, const Arguments& words) {
  return add_study<AblateOptions>(
      app, words, kAblate, declare,
      [](const AblateOptions& options) { return batch_inputs(kAblate.name, options); }, answer);
}

}  // namespace leviosim::tools
