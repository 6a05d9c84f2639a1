#include "tools/app/study/flights/benchmark_flights_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "sim/base/error.h"
#include "sim/base/printable.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/cli/version.h"
#include "tools/app/html_report/report_option.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/batch_plan.h"
#include "tools/app/study/flights/benchmark.h"
#include "tools/app/study/flights/benchmark_files.h"
#include "tools/app/study/flights/benchmark_report.h"
#include "tools/app/study/flights/flight_plan.h"
#include "tools/app/study/flights/piece_figures.h"

namespace leviosim::tools {
namespace {

/// The content of manifest.json. Nothing in it depends on the host or on what was found in caches.
Json benchmark_manifest(const Benchmark& benchmark, const Measure& how, const Words& command_line) {
  const FlightPlan& plan = benchmark.plan;
  Json document = study_manifest("leviosim flight benchmark manifest", command_line);
  document["plan"] = {{"name", plan.name}, {"text", plan.text}};
  document["variants"] = Json::array();
  for (const FlightVariant& variant : plan.variants) document["variants"].push_back(variant.name());
  document["seeds"] = plan.seeds;
  document["measure"] = measure_text(how);
  document["drawn_by"] = flight_version();
  for (const FlightMotion& motion : benchmark.motions)
    document["motions"].push_back({{"name", motion.sequence.name},
                                   {"frames", motion.sequence.frames},
                                   {"path_m", rounded(motion.sequence.path_m)},
                                   {"inputs_sha256", motion.sequence.inputs},
                                   {"starts", motion.starts.frames},
                                   {"starts_at_rest", motion.starts.at_rest}});
  return document;
}

namespace fs = std::filesystem;

struct FlightWords {
  std::string plan;
  std::string motions;
  std::vector<std::string> profiles;
  std::vector<std::string> overrides;
  std::vector<std::string> seeds;
  RunnerWords runner;
  std::string out;
  std::string report;
  bool list = false;
  bool force = false;
  bool quiet = false;
  bool json = false;
};

/// What the command line says in place of the plan, or in addition to it.
FlightPlan plan_of(const FlightWords& words) {
  FlightPlan plan = flight_plan_named(words.plan);
  if (!words.profiles.empty()) {
    plan.variants.clear();
    for (const std::string& profile : known_profiles(words.profiles))
      plan.variants.push_back({profile, {}});
  }
  for (const vio::Assignment& a : native_workload(words.overrides))
    for (FlightVariant& variant : plan.variants) {
      for (const vio::Assignment& own : variant.workload)
        if (own.parameter == a.parameter)
          throw InputError(
              fmt::format("-p {}: the plan sets it itself, in '{}'", a.text(), variant.name()));
      variant.workload.push_back(a);
    }
  if (!words.seeds.empty()) plan.seeds = batch_seeds(words.seeds);
  check_variants(plan);
  return plan;
}

outputs::OutputRequest out_request(const FlightWords& words, const FlightPlan& plan) {
  outputs::OutputRequest request{.option = "--out", .path = words.out, .replace = words.force};
  for (const auto* folders : {&plan.motions, &plan.recordings})
    for (const std::string& folder : *folders)
      request.inputs.push_back(fs::path(words.motions) / folder);
  if (fs::path(words.plan).has_parent_path()) request.inputs.emplace_back(words.plan);
  return request;
}

void run(const CLI::App& command, const FlightWords& words, const Words& command_line) {
  require(command, "PLAN", "a name or a file: tools/app/study/flights/README.md");
  require(command, "--motions", "the folder with the motions of the plan");
  if (!words.list) require(command, "--out", "a folder for the results");
  FlightPlan plan = plan_of(words);
  const RunnerOptions options = runner_options(words.runner, "run", words.quiet);
  if (words.list) {
    print(Printout(list_text(make_benchmark(std::move(plan), words.motions)), true));
    return;
  }
  std::optional<outputs::OutputFile> page = claimed_report(words.report, words.force);
  outputs::OutputFolder out(out_request(words, plan));
  const Benchmark benchmark = make_benchmark(std::move(plan), words.motions);
  const Measure how;
  std::vector<Point> runs = benchmark_runs(benchmark);
  draw_flights(benchmark, how, options, runs);
  const std::vector<RunOutcome> outcomes = run_outcomes(runs, how, options);
  const BenchmarkResult result = condense(benchmark, runs, outcomes);
  const Table rows = benchmark_runs_table(benchmark, runs, outcomes, how);
  const std::string json = json_text(benchmark_json(benchmark, result), 1) + '\n';
  const std::vector<std::string> next{
      fmt::format("leviosim run --profile {} --data {} --record --out mine",
                  benchmark.plan.variants.front().profile,
                  shell_word(benchmark.motions.front().sequence.folder))};
  const Printout text = printout(
      words.json,
      [&] {
        return Printout(fmt::format("leviosim {}: {}, {} pieces, {} native runs\n{}", version(),
                                    printable(benchmark.plan.name), benchmark.pieces.size(),
                                    runs.size(), benchmark_text(benchmark, result)))
            .ending(benchmark_conclusion(benchmark, result), next);
      },
      [&] { return json; });
  publish(out, text, [&] {
    out.write("runs.csv", csv_text(rows));
    out.write("pieces.csv", csv_text(piece_rows(benchmark, result)));
    out.write("table.md", benchmark_markdown(benchmark, result));
    out.write("table.json", json);
    out.write("manifest.json",
              json_text(benchmark_manifest(benchmark, how, command_line), 2) + '\n');
  });
  if (page) publish_report(page, benchmark_page(benchmark, result, rows), !words.json);
}

std::string plan_names() {
  std::vector<std::string_view> names;
  for (const base::BuiltinFile& plan : builtin_flight_plans()) names.push_back(plan.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

Command add_benchmark_flights_command(CLI::App& app, const Words& words) {
  CLI::App* command = app.add_subcommand("benchmark-flights",
                                         "Accuracy on rendered flights, in worlds not used for "
                                         "tuning and in others, also from starts in mid-air");
  const auto typed = std::make_shared<FlightWords>();
  const TextOptions add{*command};
  command->add_option("PLAN", typed->plan, fmt::format("a YAML file, or one of {}", plan_names()));
  add("--motions", typed->motions, "DIR",
      "folder with an ASL folder for each motion and recording of the plan (motions need no "
      "images)");
  add("--profile", typed->profiles, "NAME,...", "of the workload, in place of the plan's variants",
      true);
  add("-p,--set", typed->overrides, "PATH=VALUE",
      "parameter of the workload in every variant; repeatable", false);
  add("--seed", typed->seeds, "N,...", "of the workload's random draws, in place of the plan's",
      true);
  add_runner_options(*command, typed->runner, "run");
  command->add_flag("--list", typed->list, "print the pieces, run nothing");
  add("--out", typed->out, "DIR", "folder for the results; must be new or empty");
  add_report_option(*command, typed->report);
  command->add_flag("--force", typed->force, "replace the results of an earlier benchmark");
  command->add_flag("--quiet", typed->quiet, "no progress");
  add_json_option(*command, typed->json);
  add_examples(*command,
               {"echo 'motions: [flight]' >start.yaml",
                "echo 'worlds: { development: [1], fresh: [2] }' >>start.yaml",
                "echo 'pieces: [20]' >>start.yaml", "echo 'every: 1' >>start.yaml",
                "leviosim benchmark-flights ./start.yaml --motions . --profile levio,next "
                "--seed 1 --out flown"});
  return {.app = command, .run = [=, &words] { run(*command, *typed, words); }, .goes_on = true};
}

}  // namespace leviosim::tools
