// The command `leviosim sweep`, its report and its page.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/interruption.h"
#include "sim/base/printable.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/exit_status.h"
#include "tools/app/cli/host.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/cli/version.h"
#include "tools/app/html_report/report_option.h"
#include "tools/app/html_report/study_page.h"
#include "tools/app/result/run_figures.h"
#include "tools/app/run/known_runs.h"
#include "tools/app/run/max_memory.h"
#include "tools/app/study/runner.h"
#include "tools/app/study/sweep/pareto_front.h"
#include "tools/app/study/sweep/plan.h"
#include "tools/app/study/sweep/point_run.h"
#include "tools/app/study/sweep/points.h"
#include "tools/app/study/sweep/sweep_check.h"
#include "tools/app/study/sweep/sweep_folder.h"
#include "tools/app/study/sweep/sweep_front.h"
#include "tools/app/study/sweep/sweep_inputs.h"
#include "tools/app/study/sweep/sweep_status.h"
#include "tools/app/study/sweep/sweep_store.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr std::size_t kMostFailures = 5;

std::string failures(SweepStore& store, const std::vector<SweepOutcome>& outcomes) {
  std::string text;
  std::size_t count = 0;
  for (const SweepOutcome& o : outcomes) {
    if (o.failure.empty()) continue;
    if (++count <= kMostFailures)
      text += fmt::format("  point {} ({}): {}\n", o.point, printable(store.settings_of(o.point)),
                          printable(o.failure));
  }
  if (count > kMostFailures) text += fmt::format("  and {} more\n", count - kMostFailures);
  return count == 0 ? text : fmt::format("{} of the points cannot run:\n{}", count, text);
}

/// How many points are done, and which cannot run, as a box of a page.
StudyBox sweep_box(SweepStore& store) {
  const std::vector<SweepOutcome> outcomes = store.outcomes();
  const std::int64_t planned = store.planned();
  const auto done = static_cast<std::int64_t>(outcomes.size());
  StudyBox box;
  box.good = done == planned;
  box.mark = fmt::format("{} of {} points are done", done, planned);
  for (const SweepOutcome& o : outcomes) {
    if (o.failure.empty()) continue;
    box.good = false;
    box.lines.push_back(
        fmt::format("point {} ({}): {}", o.point, store.settings_of(o.point), o.failure));
  }
  box.sentence = sweep_conclusion(store);
  if (box.lines.size() > kMostFailures) {
    box.lines.resize(kMostFailures);
    box.lines.push_back("and more: column failure of the points");
  }
  return box;
}

/// Command lines that say more about a sweep in that folder: what differs between its first point
/// and the first of the front.
std::vector<std::string> after_sweep(SweepStore& store, const std::string& folder) {
  for (const SweepOutcome& best : pareto_front(store.outcomes()))
    if (best.point != 1)
      return {fmt::format("leviosim compare {0}:1 {0}:{1}", shell_word(folder), best.point)};
  return {};
}

/// How many points are done, which failed and which are open, and the Pareto front.
std::string sweep_report(SweepStore& store) {
  const std::vector<SweepOutcome> outcomes = store.outcomes();
  const std::int64_t planned = store.planned();
  const auto open = planned - static_cast<std::int64_t>(outcomes.size());
  std::string text = fmt::format("{} of {} points are done", outcomes.size(), planned);
  text += open > 0 ? fmt::format(", {} are open\n", open) : std::string("\n");
  text += failures(store, outcomes);
  return text + front_text(store);
}

/// "platform.cluster.clock" → "cluster.clock".
std::string title_of(const std::string& parameter) {
  constexpr std::string_view kPlatform = "platform.";
  return parameter.rfind(kPlatform, 0) == 0 ? parameter.substr(kPlatform.size()) : parameter;
}

bool is_objective(std::string_view statistic) {
  return std::any_of(kObjectives.begin(), kObjectives.end(),
                     [&](const Objective& o) { return o.statistic == statistic; });
}

/// Whether the points meet a budget. That they are done is then no good news of its own.
void add_check(const SweepCheck& check, std::vector<StudyBox>& boxes) {
  constexpr std::string_view kPrefix = "verdict: ";
  const bool is_met = check.missed == 0;
  if (!is_met && boxes.front().good == true) boxes.front().good.reset();
  boxes.insert(boxes.begin(), {.good = is_met,
                               .mark = is_met ? "budget met" : "budget NOT met",
                               .sentence = check.verdict.substr(kPrefix.size()),
                               .lines = {}});
}

/// The data of the page, after the store has been published.
Json sweep_page(SweepStore& store, const std::optional<SweepCheck>& check) {
  const std::vector<std::string> parameters = store.parameter_names();
  StudyPage page;
  page.title = "A sweep";
  page.boxes = {sweep_box(store)};
  if (check) add_check(*check, page.boxes);
  if (Table front = sweep_front(store); !front.rows().empty())
    page.found = {{"Points that no other beats in all figures", std::move(front)}};
  const Table points = read_csv(kSweepCsv, store.csv());
  page.points = Table(points.heads());
  for (std::vector<Cell> row : points.rows()) {
    for (Cell& cell : row)
      if (const auto* text = std::get_if<std::string>(&cell.value()))
        cell = readable_setting(*text);
    page.points.add(std::move(row));
  }
  const auto setup = [](std::string title, std::string key) -> Head {
    return {.title = std::move(title), .key = std::move(key), .is_setup = true};
  };
  page.columns = {setup("point", "point")};
  for (const std::string& name : parameters) page.columns.push_back(setup(title_of(name), name));
  for (const Objective& o : kObjectives)
    page.columns.push_back(
        {.title = o.title, .key = o.figure, .unit = o.shown_unit, .scale = o.scale});
  for (const FigureRow& row : figure_rows())
    if (!is_objective(row.statistic) && !row.phrase.empty() && !row.title.empty())
      page.columns.push_back({.title = std::string(row.title),
                              .key = std::string(row.statistic),
                              .unit = std::string(row.title_unit),
                              .scale = row.scale,
                              .more_is_better = row.more_is_better});
  page.columns.push_back({.title = "completion",
                          .key = "accuracy.completion",
                          .unit = "%",
                          .scale = 100,
                          .more_is_better = true});
  page.columns.push_back({.title = "failure", .key = "failure"});
  if (!parameters.empty() && parameters.size() <= 2) {
    page.curves = {
        parameters.front(), parameters.size() == 2 ? parameters.back() : std::string(), {}};
    for (const Objective& o : kObjectives) page.curves->y.push_back(o.figure);
  }
  page.x = kObjectives[0].figure;
  page.y = kObjectives[1].figure;
  page.colour = parameters.size() > 1 ? parameters.back() : std::string();
  return study_report(page);
}

// `leviosim sweep`: many points of one plan, by replay where there is a trace, else by live runs.

namespace fs = std::filesystem;

constexpr std::int64_t kMostShards = 1'000'000;

struct SweepArguments {
  std::string plan;
  std::string out;
  std::string point;
  std::string shard;
  RunnerArguments runner;
  std::string memory;
  std::string budget;
  std::vector<std::string> merge;
  std::string report;
  std::string task_minutes;
  bool list = false;
  bool status = false;
  bool force = false;
  bool quiet = false;
  bool json = false;
};

/// Numbers of the points that --point or --shard ask for.
std::vector<std::size_t> chosen_points(const SweepArguments& words, std::size_t count) {
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
  return table_document(
      "sweep",
      read_csv(csv.shown_path(), base::read_file(csv.shown_path(), base::InputKind::table)));
}

/// What of the points is neither in the file nor in the cache.
Tally run_points(const Sweep& sweep, const std::vector<std::size_t>& chosen, SweepStore& store,
                 const RunnerOptions& options) {
  const std::set<int> finished = store.finished();
  const std::vector<SweepPoint>& points = sweep.expansion.points;
  PointBatch batch{.keeps_failures = false};
  std::vector<std::size_t> open;
  for (const std::size_t i : chosen) {
    if (finished.count(static_cast<int>(i) + 1) > 0) continue;
    throw_if_interrupted();
    open.push_back(i);
    batch.keys.push_back(points[i].key);
  }
  batch.before = chosen.size() - open.size();
  KnownRuns known;
  SweepEstimate estimate(open.size(), options.threads, options.progress);
  batch.compute = [&](std::size_t i) {
    const auto begin = std::chrono::steady_clock::now();
    RunRecord outcome =
        run_point(resolve(sweep.plan, points[open[i]].settings, sweep.inputs,
                          fmt::format("{}: point {}", sweep.plan.file, open[i] + 1)),
                  known);
    estimate.take(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    return outcome;
  };
  // In the order of the plan, so that the file has the same bytes however many run at a time. Those
  // that wait for one before them are in the cache if the program is killed.
  std::map<std::size_t, RunRecord> waiting;
  std::size_t next = 0;
  batch.take = [&](std::size_t i, const RunRecord& outcome) {
    waiting.emplace(i, outcome);
    for (auto first = waiting.begin(); first != waiting.end() && first->first == next; ++next) {
      store.put(static_cast<int>(open[next]) + 1, first->second);
      first = waiting.erase(first);
    }
  };
  return run_points(batch, options);
}

Printout with_conclusion(std::string report, SweepStore& store, const std::string& folder) {
  return Printout(std::move(report))
      .ending("in short: " + sweep_conclusion(store), after_sweep(store, folder));
}

void merge(const SweepArguments& words) {
  if (words.merge.size() < 2)
    throw InputError("--merge: expected OUT IN..., the folder to merge into and those to merge");
  for (std::size_t i = 1; i < words.merge.size(); ++i)
    SweepStore{fs::path(words.merge[i])};  // refused before anything is written
  SweepFolder out(
      {"--merge", words.merge.front(), {words.merge.begin() + 1, words.merge.end()}, {}});
  if (words.force) out.empty();
  SweepStore(fs::path(words.merge[1])).copy_plan_to(out.path());
  SweepStore store(out.path());
  for (std::size_t i = 1; i < words.merge.size(); ++i) {
    throw_if_interrupted();
    store.merge(SweepStore(fs::path(words.merge[i])));
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
  if (repeated > 0) text += fmt::format(", {} duplicates", repeated);
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

/// --status, which writes nothing.
void print_status(const SweepArguments& words, const Sweep& sweep) {
  constexpr const char* kTenMinutes = "10";
  const double task_s =
      60 * parse_positive("--task-minutes",
                          words.task_minutes.empty() ? kTenMinutes : words.task_minutes);
  const SweepStatus status = sweep_status(words.out, sweep.expansion.points, [&](std::size_t i) {
    KnownRuns known;
    run_point(resolve(sweep.plan, sweep.expansion.points[i].settings, sweep.inputs,
                      fmt::format("{}: point {}", sweep.plan.file, i + 1)),
              known);
  });
  const std::string text = status_text(status, words.plan, task_s);
  const std::size_t answer = text.find('\n');
  const std::string next = fmt::format("leviosim sweep {} --out {}", shell_word(words.plan),
                                       words.out.empty() ? "swept" : shell_word(words.out));
  print(printout(
      words.json,
      [&] { return Printout(text.substr(answer + 1)).ending(text.substr(0, answer), {next}); },
      [&] { return json_text(status_json(status, task_s), 1) + '\n'; }));
}

void run_plan(const SweepArguments& words) {
  SweepInputs inputs(fs::absolute(words.plan).parent_path(),
                     ProgressLine::style_of_stderr(words.quiet), trace_memory(words.memory));
  const SweepPlan plan = read_plan(words.plan, inputs);
  const Expansion expansion = expand(plan, inputs);
  if (words.list) return print(Printout(list_text(expansion), true));
  if (words.status) return print_status(words, {plan, expansion, inputs});
  if (!words.task_minutes.empty())
    throw InputError("sweep: --task-minutes is for --status; expected both, or none");
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
  const Tally tally = run_points({plan, expansion, inputs}, chosen, store, options);
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
  std::optional<SweepCheck> check;
  if (budget) check = check_sweep(*budget, plan, expansion.points, inputs, store);
  if (page) publish_report(page, sweep_page(store, check), !words.json);
  if (elsewhere) throw InputError(*elsewhere);
  bool is_met = !has_failures(store);
  if (check) {
    print(Printout(check->text).ending(check->verdict, after_sweep(store, words.out)));
    is_met = is_met && check->missed == 0;
  }
  if (!is_met) throw LimitNotMet();
}

void run(const CLI::App& command, const SweepArguments& words) {
  if (words.merge.empty()) {
    require(command, "PLAN", "a file that says which points (tools/app/study/sweep/README.md)");
    run_plan(words);
    return;
  }
  for (const char* option :
       {"PLAN", "--out", "--list", "--status", "--point", "--shard", "--budget", "--report"})
    if (command.count(option) > 0)
      throw InputError(fmt::format("sweep: --merge OUT IN... takes no {}", option));
  merge(words);
}

}  // namespace

Command add_sweep_command(CLI::App& app, const Arguments&) {
  CLI::App* command = app.add_subcommand(
      "sweep", "Many chips, parameters, profiles, flights or seeds: all points of a plan");
  const auto words = std::make_shared<SweepArguments>();
  const TextOptions add{*command};
  command->add_option("PLAN", words->plan, "YAML file: tools/app/study/sweep/README.md");
  add("--out", words->out, "DIR", "folder for the results; a sweep that it holds is continued");
  add("--budget", words->budget, "FILE",
      "limits that every point has to meet; those with a sign are relative to point 1");
  command->add_flag("--list", words->list, "print the points with their numbers, run nothing");
  command->add_flag(
      "--status", words->status,
      "say which part is done in --out DIR or its folders, and how long the rest takes");
  add("--task-minutes", words->task_minutes, "N",
      "status: length of tasks to share the rest in [10]");
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
                "leviosim sweep fpus.yaml --list", "leviosim sweep fpus.yaml --status",
                "leviosim sweep fpus.yaml --out swept"});
  add_json_option(*command, words->json);
  return {.app = command, .run = [=] { run(*command, *words); }, .goes_on = true};
}

}  // namespace leviosim::tools
