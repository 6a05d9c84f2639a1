// `leviosim ablate`: the paper's table of pipeline configurations, for any sequences and image
// sizes. Its folder:
//
//   manifest.json   what the batch was made from
//   runs.csv        a row per run
//   table.md        the table that is printed
//   table.json      its rows, with more digits
#include "tools/commands/commands.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "tools/app/cli/outputs.h"
#include "tools/app/cli/version.h"
#include "tools/app/study/ablate/ablation.h"
#include "tools/app/study/ablate/published_accuracy.h"
#include "tools/app/study/run_outcome.h"

namespace leviosim::tools {
namespace {

void run(const CLI::App& command, const BatchWords& words, const Words& command_line) {
  const BatchPlan plan = make_plan(command, words);
  const std::vector<Point> runs = ablation_runs(plan);
  const std::vector<RunOutcome> outcomes = run_outcomes(plan, runs);
  const std::vector<AblationRow> rows = ablation_rows(plan, runs, outcomes, paper_accuracy());
  const Printout text = printout(
      words.json,
      [&] {
        return Printout({fmt::format("leviosim {}: {} native runs\n{}", version(), runs.size(),
                                     ablation_text(plan, rows)),
                         accuracy_comparison(plan, rows, paper_accuracy(), other_accuracy())})
            .ending(ablation_conclusion(rows), after_batch(plan));
      },
      [&] { return json_text(ablation_json(plan, rows), 2) + '\n'; });
  publish(*plan.out, text, [&] {
    plan.out->write("runs.csv", runs_csv(runs, outcomes, plan.measure));
    plan.out->write("table.md", ablation_markdown(plan, rows));
    plan.out->write("table.json", json_text(ablation_json(plan, rows), 2) + '\n');
    plan.out->write("manifest.json", json_text(batch_manifest(plan, command_line), 2) + '\n');
  });
}

}  // namespace

Command add_ablate_command(CLI::App& app, const Words& words) {
  CLI::App* command = app.add_subcommand(
      "ablate", "The paper's table of pipeline configurations, over given sequences");
  const auto typed = std::make_shared<BatchWords>();
  add_batch_options(*command, *typed);
  add_examples(*command, {"leviosim ablate --data flight --profile levio,next --size "
                          "160x120,320x240 --seed 1 --relative 0.5 --out ablated"});
  add_json_option(*command, typed->json);
  return {command, [=, &words] { run(*command, *typed, words); }};
}

}  // namespace leviosim::tools
