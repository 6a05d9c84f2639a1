// `leviosim explore`: the paper's parameter sweep. Its folder:
//
//   manifest.json   what the batch was made from
//   runs.csv        a row per run
//   points.csv      a row per point, profile and sequence: medians and spread
//   best.md         the points of least error
#include "tools/commands/commands.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <limits>
#include <memory>

#include "sim/base/error.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/version.h"
#include "tools/app/html_report/report_file.h"
#include "tools/app/report/table_document.h"
#include "tools/app/study/explore/exploration.h"

namespace leviosim::tools {
namespace {

constexpr std::int64_t kMostPoints = 1'000'000;

struct ExploreWords {
  BatchWords batch;
  std::vector<std::string> vary;
  std::string points = "40";
  std::string sample_seed = "1";
  std::string report;
};

std::vector<Dimension> dimensions_of(const ExploreWords& words) {
  std::vector<Dimension> dimensions;
  for (const std::string& text : words.vary) dimensions.push_back(parse_dimension(text));
  if (dimensions.empty()) dimensions = paper_dimensions();
  for (std::size_t i = 0; i < dimensions.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (dimensions[k].parameter == dimensions[i].parameter)
        throw InputError(fmt::format("--vary {}: is given twice", dimensions[i].parameter->name));
  return dimensions;
}

/// What only explorations need.
void check_plan(const BatchPlan& plan, const std::vector<Dimension>& dimensions) {
  if (plan.sizes.size() > 1)
    throw InputError("explore: --size: expected one image size; ablate compares several");
  for (const vio::Assignment& a : plan.workload)
    for (const Dimension& d : dimensions)
      if (a.parameter == d.parameter)
        throw InputError(fmt::format("-p {}: is varied; choose what is with --vary", a.text()));
  for (const Sequence& s : plan.sequences)
    if (s.path_m <= plan.measure.length_m)
      throw InputError(
          fmt::format("--relative {:g}: the path of {} is only {:.2f} m long; expected less",
                      plan.measure.length_m, s.folder, s.path_m));
}

Json manifest_of(const BatchPlan& plan, const ExploreWords& words,
                 const std::vector<Dimension>& dimensions, const Words& command_line) {
  Json manifest = batch_manifest(plan, command_line);
  manifest["points"] = words.points;
  manifest["sample_seed"] = words.sample_seed;
  for (const Dimension& d : dimensions)
    manifest["dimensions"].push_back({{"name", d.parameter->name},
                                      {"low", vio::value_text(*d.parameter, d.low)},
                                      {"high", vio::value_text(*d.parameter, d.high)},
                                      {"unit", d.parameter->unit}});
  return manifest;
}

void run(const CLI::App& command, const ExploreWords& words, const Words& command_line) {
  const std::vector<Dimension> dimensions = dimensions_of(words);
  const auto count =
      static_cast<std::size_t>(parse_whole("--points", words.points, 1, kMostPoints));
  const auto seed = static_cast<std::uint64_t>(
      parse_whole("--sample-seed", words.sample_seed, 0, std::numeric_limits<std::int64_t>::max()));
  std::optional<outputs::OutputFile> page = claimed_report(words.report, words.batch.force);
  const BatchPlan plan = make_plan(command, words.batch);
  check_plan(plan, dimensions);
  const auto points = sample_points(dimensions, count, seed);
  const std::vector<Point> runs = exploration_runs(plan, points);
  const std::vector<RunOutcome> outcomes = run_outcomes(plan, runs);
  const std::vector<ExploredPoint> explored = explored_points(plan, points, runs, outcomes);
  const Printout text = printout(
      words.batch.json,
      [&] {
        return Printout(fmt::format("leviosim {}: {} points, {} native runs\n{}", version(),
                                    points.size(), runs.size(), best_text(plan, explored)))
            .ending(exploration_conclusion(plan, explored), after_batch(plan));
      },
      [&] { return table_document("exploration", points_csv(dimensions, explored)); });
  publish(*plan.out, text, [&] {
    outputs::OutputFolder& out = *plan.out;
    out.write("runs.csv", runs_csv(runs, outcomes, plan.measure, point_columns(plan, dimensions)));
    out.write("points.csv", points_csv(dimensions, explored));
    out.write("best.md", best_markdown(plan, explored));
    out.write("manifest.json",
              json_text(manifest_of(plan, words, dimensions, command_line), 2) + '\n');
  });
  if (page) publish_report(page, exploration_page(plan, dimensions, explored), !words.batch.json);
}

}  // namespace

Command add_explore_command(CLI::App& app, const Words& words) {
  CLI::App* command = app.add_subcommand(
      "explore", "The paper's parameter sweep: accuracy over parameters of the workload");
  const auto typed = std::make_shared<ExploreWords>();
  add_batch_options(*command, typed->batch);
  add_report_option(*command, typed->report);
  add_json_option(*command, typed->batch.json);
  const TextOptions add{*command};
  add("--vary", typed->vary, "NAME[=LOW:HIGH]",
      "parameter to vary, off and on if it is a switch; repeatable [the paper's five]");
  add("--points", typed->points, "N", "of the parameters, the profile's first [40]");
  add("--sample-seed", typed->sample_seed, "N", "of the points' random draws [1]");
  add_examples(*command,
               {"leviosim explore --data flight --profile levio --vary workload.window=6:12 "
                "--points 3 --seed 1 --relative 0.5 --out explored"});
  return {command, [=, &words] { run(*command, *typed, words); }};
}

}  // namespace leviosim::tools
