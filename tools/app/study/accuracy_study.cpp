#include "tools/app/study/accuracy_study.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/base/text.h"
#include "tools/app/cli/host.h"
#include "tools/app/cli/version.h"
#include "tools/app/run/flight_cache.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/simulate.h"
#include "tools/app/run/workload.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

template <class T>
std::optional<Banded> banded(const std::optional<sim::Estimate<T>>& figure) {
  if (!figure) return std::nullopt;
  return Banded{figure->value.count(), figure->low().count(), figure->high().count()};
}

std::optional<LoopOutcome> loop_of(const RunResult& run) {
  const std::optional<CameraFigures> camera = camera_figures(run);
  if (!camera) return std::nullopt;
  LoopOutcome loop{*camera, {}, {}};
  if (const std::optional<RunEnergy> energy = energy_of(run)) {
    loop.power_w = banded(energy->mean_power());
    loop.frame_j = banded(energy->per_frame());
  }
  return loop;
}

constexpr const char* kAte = "ate_m";

/// The numbers of an outcome by their names: all of them are written to figures, or read.
class Numbers {
 public:
  explicit Numbers(RunRecord& record) : writes_to_(&record) {}
  explicit Numbers(const RunRecord& record) {
    for (const Statistic& s : record.statistics)
      if (s.value) read_[s.name] = *s.value;
  }

  void all_of(RunOutcome& outcome) {
    take(kAte, outcome.ate_m);
    take("relative_percent", outcome.relative_percent);
    take("sub_trajectories", outcome.sub_trajectories);
    take("frames", outcome.frames);
    take("matched", outcome.matched);
    take("completion", outcome.completion);
    take("map_restarts", outcome.map_restarts);
    take("health", outcome.health);
    take("scale.windows", outcome.scale.windows);
    take("scale.mean", outcome.scale.mean);
    take("scale.sigma", outcome.scale.sigma);
    take("end_drift_m", outcome.end_drift_m);
    take("path_m", outcome.path_m);
    if (read_.count(kArrived) > 0) outcome.loop.emplace();
    if (outcome.loop) all_of(*outcome.loop);
  }

 private:
  static constexpr const char* kArrived = "arrived";  // which all loops have

  void all_of(LoopOutcome& loop) {
    take(kArrived, loop.camera.arrived);
    take("processed", loop.camera.processed);
    take("dropped", loop.camera.dropped);
    take("late", loop.camera.late);
    take("waited", loop.camera.waited);
    take("most_found", loop.camera.most_found);
    take("p50_ns", loop.camera.latency.p50_ns);
    take("p95_ns", loop.camera.latency.p95_ns);
    take("p99_ns", loop.camera.latency.p99_ns);
    take("max_ns", loop.camera.latency.max_ns);
    take("power_w", loop.power_w);
    take("frame_j", loop.frame_j);
  }
  template <class Number>
  void take(const std::string& name, Number& value) {
    if (writes_to_ != nullptr)
      writes_to_->statistics.push_back({.name = name, .value = static_cast<double>(value)});
    else
      value = static_cast<Number>(number(name, !std::is_floating_point_v<Number>));
  }
  void take(const std::string& name, Banded& figure) {
    take(name, figure.value);
    take(name + ".low", figure.low);
    take(name + ".high", figure.high);
  }
  template <class Value>
  void take(const std::string& name, std::optional<Value>& value) {
    if (read_.count(name) > 0) value.emplace();
    if (value) take(name, *value);
  }
  double number(const std::string& name, bool whole) const {
    constexpr double kMost = 0x1p53;  // whole numbers up to here are exact
    const auto it = read_.find(name);
    if (it == read_.end() || (whole && !(it->second >= 0 && it->second <= kMost)))
      throw InputError(
          fmt::format("the cache of finished runs has no '{}' of one; remove it, or choose another "
                      "with --cache",
                      name));
    return it->second;
  }

  RunRecord* writes_to_ = nullptr;
  std::map<std::string, double> read_;
};

RunOutcome compute(const Point& point, const Measure& how) {
  RunRequest request = point.request;
  request.evaluate = false;  // outcome_of() does, and takes note of what diverged
  const RunResult result = simulate(request, [](const Progress&) { throw_if_interrupted(); });
  return outcome_of(result, point.sequence->truth, how);
}

/// The same input twice would only look like more runs.
template <class T>
std::vector<T> without_repetitions(const std::string& option, std::vector<T> values,
                                   const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i)
    if (std::find(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(i), words[i]) !=
        words.begin() + static_cast<std::ptrdiff_t>(i))
      throw InputError(fmt::format("{} '{}': is given twice", option, words[i]));
  return values;
}

std::vector<traces::ImageSize> parse_sizes(const std::vector<std::string>& words) {
  std::vector<traces::ImageSize> sizes;
  for (const std::string& word : words) sizes.push_back(parse_size(word));
  return without_repetitions("--size", sizes, words);
}

/// Digests of what is read are kept with the folder's name for the messages.
std::vector<Sequence> open_all(const BatchWords& words, const BatchPlan& plan) {
  std::vector<Sequence> sequences;
  for (const std::string& word : words.data) {
    throw_if_interrupted();
    NamedFolder named = parse_named_folder(word);
    if (named.folder == "synthetic") named.folder = cached_flight(plan.runner.progress).string();
    sequences.push_back(open_sequence(named, plan.frames, plan.sizes));
    for (std::size_t i = 0; i + 1 < sequences.size(); ++i)
      if (sequences[i].inputs == sequences.back().inputs)
        throw InputError(
            fmt::format("--data {}: holds the same flight as {}", word, sequences[i].folder));
  }
  return sequences;
}

}  // namespace

RunOutcome measure(const traces::Trajectory& estimate, const traces::Trajectory& truth,
                   const Measure& how) {
  return measure(estimate, truth, how, estimate.size());
}

RunOutcome measure(const traces::Trajectory& estimate, const traces::Trajectory& truth,
                   const Measure& how, std::size_t expected) {
  RunOutcome outcome;
  outcome.frames = expected;
  try {
    const traces::Evaluation evaluation =
        traces::evaluate(estimate, truth, {.alignment = how.alignment, .expected_poses = expected});
    const traces::RelativeErrors relative = traces::relative_errors(evaluation, how.length_m);
    outcome.ate_m = evaluation.translation.rmse;
    if (relative.count > 0) outcome.relative_percent = relative.translation.mean;
    outcome.sub_trajectories = relative.count;
    outcome.matched = evaluation.matched;
    outcome.completion = evaluation.completion;
    outcome.path_m = evaluation.path_length_m;
    outcome.protocol = evaluation.protocol;
    outcome.scale = traces::summarize_scales(traces::scales_in_windows(evaluation));
    outcome.end_drift_m = traces::end_drift(evaluation);
  } catch (const InputError& failure) {
    outcome.failure = failure.what();
  }
  return outcome;
}

RunOutcome outcome_of(const RunResult& run, const traces::Trajectory& truth, const Measure& how) {
  const std::size_t expected = expected_poses(run);
  RunOutcome outcome;
  if (std::string why = why_incomparable(run); !why.empty())
    outcome.failure = std::move(why);
  else if (run.camera && run.trajectory.size() < kFewestPoses)
    outcome.failure = "fewer than three frames were processed";
  else
    outcome = measure(run.trajectory, truth, how, expected);
  outcome.frames = expected;
  for (const FrameResult& frame : run.frames)
    outcome.map_restarts += static_cast<std::size_t>(frame.map_restarts);
  if (!run.frames.empty()) outcome.health = static_cast<Health>(run.frames.back().health);
  if (run.camera) outcome.loop = loop_of(run);
  return outcome;
}

std::optional<double> error_of(const RunOutcome& outcome) {
  const bool diverged = !outcome.ate_m || *outcome.ate_m > outcome.path_m;
  return diverged ? std::nullopt : outcome.ate_m;
}

std::string error_text(const std::optional<double>& error, int decimals) {
  return figure_text(error, decimals, kDiverged);
}

Json figure_json(const std::optional<double>& figure) {
  return figure ? rounded(*figure) : Json(nullptr);
}

RunRecord record_of(const RunOutcome& outcome) {
  RunRecord record;
  record.failure = outcome.failure;
  RunOutcome written = outcome;
  Numbers(record).all_of(written);
  for (Statistic& s : record.statistics)
    if (s.name == kAte) s.protocol = outcome.protocol;
  return record;
}

RunOutcome run_outcome_of(const RunRecord& record) {
  RunOutcome outcome;
  outcome.failure = record.failure;
  if (const Statistic* ate = record.find(kAte)) outcome.protocol = ate->protocol;
  Numbers(record).all_of(outcome);
  return outcome;
}

std::string run_key(const Point& point, const Measure& how, const platform::Schema& schema) {
  return point_key(fmt::format("errors, drift {} {}", name_of(how.alignment), how.length_m),
                   identity_of(point, schema));
}

std::vector<RunOutcome> run_outcomes(const std::vector<Point>& points, const Measure& how,
                                     const RunnerOptions& options) {
  std::vector<RunOutcome> outcomes(points.size());
  PointBatch batch;
  const platform::Schema schema;
  for (const Point& point : points) {
    throw_if_interrupted();
    batch.keys.push_back(run_key(point, how, schema));
  }
  batch.compute = [&](std::size_t i) { return record_of(compute(points[i], how)); };
  batch.take = [&](std::size_t i, const RunRecord& o) { outcomes[i] = run_outcome_of(o); };
  run_points(batch, options);
  return outcomes;
}

std::vector<std::vector<RunOutcome>> by_row(const std::vector<Point>& points,
                                            const std::vector<RunOutcome>& outcomes,
                                            std::size_t rows) {
  check_equal(outcomes.size(), points.size(), "an outcome per point");
  std::vector<std::vector<RunOutcome>> all(rows);
  for (std::size_t i = 0; i < points.size(); ++i) all.at(points[i].row).push_back(outcomes[i]);
  return all;
}

Table run_rows(const std::vector<Point>& points, const std::vector<RunOutcome>& outcomes,
               const Measure& how, RunColumns columns) {
  check_equal(points.size(), outcomes.size(), "an outcome per run");
  using R = const FinishedRun&;
  for (const RunColumns::value_type& column :
       RunColumns{{{.title = "motion", .key = "sequence", .is_setup = true},
                   [](R r) { return r.point.sequence->name; }},
                  {{.key = "folder"}, [](R r) { return r.point.sequence->folder; }},
                  {{.key = "width"}, [](R r) { return r.point.request.image_size.width; }},
                  {{.key = "height"}, [](R r) { return r.point.request.image_size.height; }},
                  {{.key = "profile"}, [](R r) { return r.point.request.profile; }},
                  {{.title = "seed", .key = "seed", .is_setup = true},
                   [](R r) { return r.point.request.seed; }},
                  {{.key = "frames"}, [](R r) { return r.outcome.frames; }},
                  {{.key = "alignment"}, [how](R) { return name_of(how.alignment); }},
                  {{.title = "error (ATE)", .key = "ate_rmse_m", .decimals = 9, .unit = "m"},
                   [](R r) { return r.outcome.ate_m; }},
                  {{.key = "relative_length_m"}, [how](R) { return how.length_m; }},
                  {{.key = "relative_translation_mean_percent", .decimals = 9},
                   [](R r) { return r.outcome.relative_percent; }},
                  {{.key = "sub_trajectories"}, [](R r) { return r.outcome.sub_trajectories; }},
                  {{.key = "matched"}, [](R r) { return r.outcome.matched; }},
                  {{.title = "completion",
                  .key = "completion",
                  .decimals = 9,
                  .unit = "%",
                  .scale = 100,
                  .more_is_better = true},
                   [](R r) { return r.outcome.completion; }},
                  {{.title = "path", .key = "path_m", .decimals = 9, .unit = "m", .is_setup = true},
                   [](R r) { return r.outcome.path_m; }},
                  {{.title = "failure", .key = "failure"}, [](R r) { return r.outcome.failure; }}})
    columns.push_back(column);
  std::vector<FinishedRun> runs;
  for (std::size_t i = 0; i < points.size(); ++i) runs.push_back({points[i], outcomes[i]});
  return table_of(columns, runs);
}

std::vector<std::uint32_t> batch_seeds(const std::vector<std::string>& words) {
  std::vector<std::uint32_t> seeds;
  for (const std::string& word : words)
    seeds.push_back(static_cast<std::uint32_t>(
        parse_whole("--seed", word, 0, std::numeric_limits<std::uint32_t>::max())));
  return without_repetitions("--seed", seeds, words);
}

std::vector<std::string> known_profiles(const std::vector<std::string>& words) {
  for (const std::string& word : words) vio::expect_profile(word);
  return without_repetitions("--profile", words, words);
}

std::vector<vio::Assignment> native_workload(const std::vector<std::string>& overrides) {
  const SplitOverrides split = split_overrides(overrides);
  if (!split.chip.empty())
    throw InputError(
        fmt::format("-p {}: runs here are native, without a chip; expected a parameter of the "
                    "workload, such as workload.window=6 (leviosim workload lists them)",
                    split.chip.front()));
  return parse_workload_overrides(split.workload);
}

void add_batch_options(CLI::App& command, BatchWords& words) {
  const TextOptions add{command};
  add("--data", words.data, "[NAME=]DIR",
      "ASL/EuRoC folder of a sequence; repeatable. Folders of one name are pooled");
  add("--profile", words.profiles, "NAME,...",
      "of the workload [levio,levio-no-imu,levio-no-imu-no-epnp]", true);
  add("--size", words.sizes, "WxH,...", "image sizes [160x120]", true);
  add("--seed", words.seeds, "N,...", "of the workload's random draws [1,2,3]", true);
  add("-p,--set", words.overrides, "PATH=VALUE",
      "parameter of the workload in every run (leviosim workload); repeatable");
  add("--frames", words.frames, "A:B", "frames, B exclusive [all]");
  add("--align", words.align, "KIND", "se3, sim3, posyaw or none [se3]");
  add("--relative", words.relative, "M", "length of sub-trajectories in metres [40]");
  add_runner_options(command, words.runner, "run");
  add("--out", words.out, "DIR", "folder for the results; must be new or empty");
  command.add_flag("--force", words.force, "replace the results of an earlier batch");
  command.add_flag("--quiet", words.quiet, "no progress");
}

BatchPlan make_plan(const CLI::App& command, const BatchWords& words) {
  require(command, "--data", "an ASL folder; repeatable");
  require(command, "--out", "a folder for the results");
  BatchPlan plan;
  plan.profiles = known_profiles(words.profiles);
  plan.sizes = parse_sizes(words.sizes);
  plan.seeds = batch_seeds(words.seeds);
  plan.workload = native_workload(words.overrides);
  if (!words.frames.empty()) plan.frames = traces::parse_frame_range(words.frames);
  plan.measure = {traces::parse_alignment(words.align),
                  parse_positive("--relative", words.relative)};
  plan.runner = runner_options(words.runner, "run", words.quiet);
  outputs::OutputRequest wanted{.option = "--out", .path = words.out, .replace = words.force};
  for (const std::string& word : words.data)
    for (const std::filesystem::path& input : data_inputs(parse_named_folder(word).folder))
      wanted.inputs.push_back(input);
  plan.out = std::make_shared<outputs::OutputFolder>(std::move(wanted));
  plan.sequences = open_all(words, plan);
  return plan;
}

Point make_run(const BatchPlan& plan, const Sequence& sequence, const std::string& profile,
               const traces::ImageSize& size, std::uint32_t seed) {
  Point run{.request = {}, .work = sequence.work, .sequence = &sequence};
  run.request.data = sequence.folder;
  run.request.profile = profile;
  run.request.frames = plan.frames;
  run.request.image_size = size;
  run.request.native = true;
  run.request.seed = seed;
  run.request.workload = plan.workload;
  return run;
}

std::vector<RunOutcome> run_outcomes(const BatchPlan& plan, const std::vector<Point>& points) {
  return run_outcomes(points, plan.measure, plan.runner);
}

std::vector<std::string> sequence_names(const BatchPlan& plan) {
  std::vector<std::string> names;
  for (const Sequence& s : plan.sequences)
    if (std::find(names.begin(), names.end(), s.name) == names.end()) names.push_back(s.name);
  return names;
}

Json study_manifest(const std::string& format, const Words& command_line) {
  Json document;
  document["format"] = format;
  document["version"] = 1;
  document["program"]["version"] = version();
  document["program"]["revision"] = revision();
  document["program"]["estimator"] = results_version();
  document["command_line"] = command_line;
  return document;
}

Json batch_manifest(const BatchPlan& plan, const Words& command_line) {
  Json document = study_manifest("leviosim batch manifest", command_line);
  document["profiles"] = plan.profiles;
  for (const traces::ImageSize& size : plan.sizes) document["sizes"].push_back(size_text(size));
  document["seeds"] = plan.seeds;
  document["workload"] = Json::array();
  for (const vio::Assignment& a : plan.workload) document["workload"].push_back(a.text());
  document["measure"] = measure_text(plan.measure);
  for (const Sequence& s : plan.sequences)
    document["sequences"].push_back({{"name", s.name},
                                     {"folder", s.folder},
                                     {"frames", s.frames},
                                     {"path_m", rounded(s.path_m)},
                                     {"inputs_sha256", s.inputs}});
  return document;
}

std::vector<std::string> after_batch(const BatchPlan& plan) {
  return {fmt::format("leviosim run --profile {} --data {} --record --out mine",
                      plan.profiles.front(), shell_word(plan.sequences.front().folder))};
}

std::string measure_text(const Measure& how) {
  return fmt::format("{}-aligned RMSE; mean translation error of sub-trajectories of {:g} m",
                     name_of(how.alignment), how.length_m);
}

std::string size_text(const traces::ImageSize& size) {
  return fmt::format("{}x{}", size.width, size.height);
}

}  // namespace leviosim::tools
