// The command `leviosim benchmark-flights`: its options and its files.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <filesystem>

#include "sim/base/error.h"
#include "sim/base/printable.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/version.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/batch_plan.h"
#include "tools/app/study/flights/benchmark.h"
#include "tools/app/study/flights/benchmark_tables.h"
#include "tools/app/study/flights/flight_plan.h"
#include "tools/app/study/flights/piece_figures.h"
#include "tools/app/study/study.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

/// Answer::manifest.
Json manifest_of(const Benchmark& benchmark, const Measure& how) {
  const FlightPlan& plan = benchmark.plan;
  Json document;
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

/// As typed. Lists stand for the single values of RunOptions.
struct FlightOptions : StudyOptions {
  std::string plan;
  std::string motions;
  std::vector<std::string> profiles;
  std::vector<std::string> seeds;
  bool list = false;
};

/// What the command line says in place of the plan, or in addition to it.
FlightPlan plan_of(const FlightOptions& options) {
  FlightPlan plan = flight_plan_named(options.plan);
  if (!options.profiles.empty()) {
    plan.variants.clear();
    for (const std::string& profile : known_profiles(options.profiles))
      plan.variants.push_back({profile, {}});
  }
  for (const vio::Assignment& a : native_workload(options.overrides))
    for (FlightVariant& variant : plan.variants) {
      for (const vio::Assignment& own : variant.workload)
        if (own.parameter == a.parameter)
          throw InputError(
              fmt::format("-p {}: the plan sets it itself, in '{}'", a.text(), variant.name()));
      variant.workload.push_back(a);
    }
  if (!options.seeds.empty()) plan.seeds = batch_seeds(options.seeds);
  check_variants(plan);
  return plan;
}

std::vector<fs::path> inputs_of(const FlightOptions& options) {
  const char* const command = "benchmark-flights";
  expect_given(command, "PLAN", options.plan.empty(),
               "a name or a file: tools/app/study/flights/README.md");
  expect_given(command, "--motions", options.motions.empty(),
               "the folder with the motions of the plan");
  expect_given(command, "--out", !options.list && options.out.empty(), "a folder for the results");
  const FlightPlan plan = plan_of(options);
  std::vector<fs::path> inputs;
  for (const auto* folders : {&plan.motions, &plan.recordings})
    for (const std::string& folder : *folders) inputs.push_back(fs::path(options.motions) / folder);
  if (fs::path(options.plan).has_parent_path()) inputs.emplace_back(options.plan);
  return inputs;
}

Answer answer(const FlightOptions& options, const RunnerOptions& runner, const Arguments&) {
  const Benchmark benchmark = make_benchmark(plan_of(options), options.motions);
  if (options.list) return {.parts = {list_text(benchmark)}, .is_list = true};
  const Measure how;
  std::vector<Point> runs = benchmark_runs(benchmark);
  draw_flights(benchmark, how, runner, runs);
  const std::vector<RunOutcome> outcomes = run_outcomes(runs, how, runner);
  const BenchmarkResult result = condense(benchmark, runs, outcomes);
  const Table all = benchmark_runs_table(benchmark, runs, outcomes, how);
  const Table pieces = piece_rows(benchmark, result);
  Answer answer{.conclusion = benchmark_conclusion(benchmark, result),
                .next = {fmt::format("leviosim run --profile {} --data {} --record --out mine",
                                     benchmark.plan.variants.front().profile,
                                     shell_word(benchmark.motions.front().sequence.folder))},
                .rows = benchmark_rows(benchmark, result),
                .page = benchmark_page(benchmark, result, all),
                .manifest = manifest_of(benchmark, how)};
  answer.parts = {fmt::format("leviosim {}: {}, {} pieces, {} native runs\n{}{}", version(),
                              printable(benchmark.plan.name), benchmark.pieces.size(), runs.size(),
                              terminal_text(answer.rows),
                              benchmark_notes(benchmark, result, "  "))};
  answer.more = {{"plan", benchmark.plan.name}, {"pieces", rows_json(pieces)}};
  answer.files = {
      {"runs.csv", csv_text(all)},
      {"pieces.csv", csv_text(pieces)},
      {"rows.csv", csv_text(answer.rows)},
      {"table.md", markdown_table(answer.rows) + '\n' + benchmark_notes(benchmark, result, "- ")}};
  return answer;
}

std::string plan_names() {
  std::vector<std::string_view> names;
  for (const base::BuiltinFile& plan : builtin_flight_plans()) names.push_back(plan.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

void declare(CLI::App& command, FlightOptions& options) {
  const TextOptions add{command};
  command.add_option("PLAN", options.plan, fmt::format("a YAML file, or one of {}", plan_names()));
  add("--motions", options.motions, "DIR",
      "folder with an ASL folder for each motion and recording of the plan (motions need no "
      "images)");
  add("--profile", options.profiles, "NAME,...", "of the workload, in place of the plan's variants",
      true);
  add("-p,--set", options.overrides, "PATH=VALUE",
      "parameter of the workload in every variant; repeatable", false);
  add("--seed", options.seeds, "N,...", "of the workload's random draws, in place of the plan's",
      true);
  command.add_flag("--list", options.list, "print the pieces, run nothing");
  command.add_flag("--quiet", options.quiet, "no progress");
}

const Study kBenchmark{"benchmark-flights",
                       "Accuracy on rendered flights, in worlds not used for tuning and in others, "
                       "also from starts in mid-air",
                       "run",
                       {"echo 'motions: [flight]' >start.yaml",
                        "echo 'worlds: { development: [1], fresh: [2] }' >>start.yaml",
                        "echo 'pieces: [20]' >>start.yaml", "echo 'every: 1' >>start.yaml",
                        "leviosim benchmark-flights ./start.yaml --motions . --profile levio,next "
                        "--seed 1 --out flown"},
                       Study::Leaves::folder};

}  // namespace

Command add_benchmark_flights_command(CLI::App& app, const Arguments& words) {
  return add_study<FlightOptions>(app, words, kBenchmark, declare, inputs_of, answer);
}

}  // namespace leviosim::tools
