// `leviosim sweep`: many points of one plan, by replay where there is a trace, else by live runs.
#include "tools/commands/commands.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <memory>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/printable_text.h"
#include "sim/base/sha256.h"
#include "tools/app/cli/interrupts.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/version.h"
#include "tools/app/html_report/report_file.h"
#include "tools/app/report/table_document.h"
#include "tools/app/run/run_request.h"
#include "tools/app/study/runner.h"
#include "tools/app/study/sweep/points.h"
#include "tools/app/study/sweep/sweep_check.h"
#include "tools/app/study/sweep/sweep_inputs.h"
#include "tools/app/study/sweep/sweep_report.h"
#include "tools/app/study/sweep/sweep_store.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostShards = 1'000'000;

struct SweepWords {
  std::string plan;
  std::string out;
  std::string point;
  std::string shard;
  RunnerWords runner;
  std::string memory;
  std::string budget;
  std::vector<std::string> merge;
  std::string report;
  bool list = false;
  bool force = false;
  bool quiet = false;
  bool json = false;
};

/// Numbers of the points that --point or --shard ask for.
std::vector<std::size_t> chosen_points(const SweepWords& words, std::size_t count) {
  std::vector<std::size_t> chosen;
  if (!words.point.empty()) {
    if (!words.shard.empty()) throw InputError("sweep: expected --point or --shard, not both");
    const std::int64_t k = parse_whole("--point", words.point, 1, static_cast<std::int64_t>(count));
    return {static_cast<std::size_t>(k - 1)};
  }
  std::size_t part = 0;
  std::size_t parts = 1;
  if (!words.shard.empty()) {
    const std::size_t slash = words.shard.find('/');
    if (slash == std::string::npos)
      throw InputError(fmt::format("--shard '{}': expected I/N, such as 1/4", words.shard));
    parts = static_cast<std::size_t>(
        parse_whole("--shard", words.shard.substr(slash + 1), 1, kMostShards));
    part = static_cast<std::size_t>(parse_whole("--shard", words.shard.substr(0, slash), 1,
                                                static_cast<std::int64_t>(parts))) -
           1;
  }
  for (std::size_t i = part; i < count; i += parts) chosen.push_back(i);
  return chosen;
}

struct Sweep {
  const SweepPlan& plan;
  const Expansion& expansion;
  SweepInputs& inputs;
};

/// The rows of sweep.csv, wherever it was put.
std::string document(const outputs::OutputFile& csv) {
  return table_document("sweep", base::read_file(csv.shown_path(), base::InputKind::table));
}

/// Outcomes for budgets hold more, so that they have keys of their own in the cache.
std::string budget_key(const std::string& key) {
  base::Sha256 digest;
  digest.add(key + " with the figures of budgets");
  return digest.hex();
}

/// What of the points is neither in the file nor in the cache.
Tally run_points(const Sweep& sweep, const std::vector<std::size_t>& chosen, SweepStore& store,
                 const RunnerOptions& options, bool for_budget) {
  const std::set<int> finished = store.finished();
  const std::vector<SweepPoint>& points = sweep.expansion.points;
  PointBatch batch{.keeps_failures = false};
  std::vector<std::size_t> open;
  for (const std::size_t i : chosen) {
    if (finished.count(static_cast<int>(i) + 1) > 0) continue;
    throw_if_interrupted();
    open.push_back(i);
    batch.keys.push_back(for_budget ? budget_key(points[i].key) : points[i].key);
  }
  batch.before = chosen.size() - open.size();
  batch.compute = [&](std::size_t i) {
    return run_point(resolve(sweep.plan, points[open[i]].settings, sweep.inputs,
                             fmt::format("{}: point {}", sweep.plan.file, open[i] + 1)),
                     for_budget);
  };
  batch.take = [&](std::size_t i, const Outcome& outcome) {
    store.put(static_cast<int>(open[i]) + 1, outcome);
  };
  return run_points(batch, options);
}

Printout with_conclusion(std::string report, SweepStore& store, const std::string& folder) {
  return Printout(std::move(report)).ending(sweep_conclusion(store), after_sweep(store, folder));
}

void merge(const SweepWords& words) {
  if (words.merge.size() < 2)
    throw InputError("--merge: expected OUT IN..., the folder to merge into and those to merge");
  for (std::size_t i = 1; i < words.merge.size(); ++i)
    SweepStore{fs::path(words.merge[i])};  // refused before anything is written
  SweepFolder out(
      {"--merge", words.merge.front(), {words.merge.begin() + 1, words.merge.end()}, {}});
  if (words.force) out.empty();
  SweepStore(fs::path(words.merge[1])).copy_plan_to(out.path());
  SweepStore store(out.path(), Database::Mode::existing);
  for (std::size_t i = 1; i < words.merge.size(); ++i) {
    throw_if_interrupted();
    SweepStore part{fs::path(words.merge[i])};
    store.merge(part);
  }
  const std::optional<std::string> elsewhere = store.publish(out.csv());
  const auto lines = [&] {
    return with_conclusion(fmt::format("leviosim {}: {} folders merged\n{}", version(),
                                       words.merge.size() - 1, sweep_report(store)),
                           store, words.merge.front());
  };
  print(printout(words.json, lines, [&] { return document(out.csv()); }),
        {{"results", words.merge.front()}});
  if (elsewhere) throw InputError(*elsewhere);
}

std::string expansion_text(const Expansion& expansion) {
  const std::size_t points = expansion.points.size();
  const std::size_t repeated = expansion.asked - points - expansion.impossible;
  std::string text = fmt::format("{} points", points);
  if (repeated > 0) text += fmt::format(", {} more that are the same as one of them", repeated);
  if (expansion.impossible > 0)
    text += fmt::format(", {} left out as impossible, the first: {}", expansion.impossible,
                        printable(expansion.first_impossible));
  return text;
}

std::string list_text(const Expansion& expansion) {
  std::string text;
  for (std::size_t i = 0; i < expansion.points.size(); ++i) {
    throw_if_interrupted();
    text += fmt::format("{}\t{}\n", i + 1, printable(expansion.points[i].settings_text()));
  }
  return text;
}

bool has_failures(SweepStore& store) {
  const std::vector<SweepOutcome> outcomes = store.outcomes();
  return std::any_of(outcomes.begin(), outcomes.end(),
                     [](const SweepOutcome& o) { return !o.failure.empty(); });
}

void run_plan(const SweepWords& words) {
  SweepInputs inputs(fs::absolute(words.plan).parent_path(),
                     ProgressLine::style_of_stderr(words.quiet), trace_memory(words.memory));
  const SweepPlan plan = read_plan(words.plan, inputs);
  const Expansion expansion = expand(plan, inputs);
  if (words.list) return print(Printout(list_text(expansion), true));
  if (words.out.empty())
    throw InputError("sweep: --out is missing; expected a folder for the results");
  expect_json_or_budget(words.json, words.budget);
  std::optional<Budget> budget;
  if (!words.budget.empty()) budget = read_budget(words.budget);
  const std::vector<std::size_t> chosen = chosen_points(words, expansion.points.size());
  const RunnerOptions options = runner_options(words.runner, "point", words.quiet);
  std::optional<outputs::OutputFile> page = claimed_report(words.report, words.force, {words.plan});
  SweepFolder out({"--out", words.out, {words.plan}, options.cache});
  if (words.force) out.empty();
  const auto begin = std::chrono::steady_clock::now();
  SweepStore store(out.path(), plan.text, expansion.points);
  store.keep_place(words.plan);
  const Tally tally =
      run_points({plan, expansion, inputs}, chosen, store, options, budget.has_value());
  const std::optional<std::string> elsewhere = store.publish(out.csv());
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const auto lines = [&] {
    return with_conclusion(
        fmt::format(
            "leviosim {}: {}\n{} computed in {:.1f} s, {} found in the cache, {} done before\n{}",
            version(), expansion_text(expansion), tally.computed, seconds, tally.found,
            tally.before, sweep_report(store)),
        store, words.out);
  };
  print(printout(words.json, lines, [&] { return document(out.csv()); }), {{"results", words.out}});
  if (page) publish_report(page, sweep_page(store), !words.json);
  if (elsewhere) throw InputError(*elsewhere);
  bool is_met = !has_failures(store);
  if (budget) {
    const SweepCheck check = check_sweep(*budget, plan, expansion.points, inputs, store);
    print(Printout(check.text).ending(check.verdict, after_sweep(store, words.out)));
    is_met = is_met && check.missed == 0;
  }
  if (!is_met) throw LimitNotMet();
}

void run(const CLI::App& command, const SweepWords& words) {
  if (words.merge.empty()) {
    require(command, "PLAN", "a file that says which points (tools/app/study/sweep/README.md)");
    run_plan(words);
    return;
  }
  for (const char* option :
       {"PLAN", "--out", "--list", "--point", "--shard", "--budget", "--report"})
    if (command.count(option) > 0)
      throw InputError(fmt::format("sweep: --merge OUT IN... takes no {}", option));
  merge(words);
}

}  // namespace

Command add_sweep_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "sweep", "Many chips, parameters, profiles, flights or seeds: all points of a plan");
  const auto words = std::make_shared<SweepWords>();
  const TextOptions add{*command};
  command->add_option("PLAN", words->plan, "YAML file: tools/app/study/sweep/README.md");
  add("--out", words->out, "DIR", "folder for the results; a sweep that it holds is continued");
  add("--budget", words->budget, "FILE",
      "limits that every point has to meet; those with a sign are relative to point 1");
  command->add_flag("--list", words->list, "print the points with their numbers, run nothing");
  add("--point", words->point, "K", "run this point only");
  add("--shard", words->shard, "I/N", "run the I-th of N shares only");
  command
      ->add_option("--merge", words->merge,
                   "put the results of folders IN together in OUT, in place of running a plan")
      ->type_name("OUT IN...")
      ->expected(2, 1'000'000);
  add_runner_options(*command, words->runner, "point");
  add_memory_option(*command, words->memory);
  add_report_option(*command, words->report);
  command->add_flag("--force", words->force, "begin anew; finished points are found in the cache");
  command->add_flag("--quiet", words->quiet, "no progress");
  add_examples(*command,
               {"echo 'base: { trace: recorded }' >fpus.yaml",
                "echo 'points: { grid: { platform.cluster.fpu.units: [1, 2, 4] } }' >>fpus.yaml",
                "leviosim sweep fpus.yaml --list", "leviosim sweep fpus.yaml --out swept"});
  add_json_option(*command, words->json);
  return {command, [=] { run(*command, *words); }};
}

}  // namespace leviosim::tools
