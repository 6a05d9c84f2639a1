#include "tools/app/study/accuracy_study.h"

#include <fmt/core.h>

#include <map>
#include <type_traits>
#include <utility>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/energy/estimate.h"
#include "tools/app/cli/host.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/result/summary.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/simulate.h"
#include "tools/app/table/terminal_table.h"
#include "traces/trajectories/end_drift.h"
#include "traces/trajectories/trajectory_errors.h"

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
    take("located_m", outcome.located_m);
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
  if (const std::optional<traces::Trajectory> located = located_poses(run);
      located && outcome.ate_m)
    outcome.located_m = measure(*located, truth, how).ate_m;
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
  return metres_text(error, decimals, kDiverged);
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
  return point_key(
      fmt::format("errors, drift, located {} {}", name_of(how.alignment), how.length_m),
      identity_of(point, schema));
}

std::vector<std::vector<RunOutcome>> by_row(const std::vector<Point>& points,
                                            const std::vector<RunOutcome>& outcomes,
                                            std::size_t rows) {
  check_equal(outcomes.size(), points.size(), "an outcome per point");
  std::vector<std::vector<RunOutcome>> all(rows);
  for (std::size_t i = 0; i < points.size(); ++i) all.at(points[i].row).push_back(outcomes[i]);
  return all;
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

std::string measure_text(const Measure& how) {
  return fmt::format("{}-aligned RMSE; mean translation error of sub-trajectories of {:g} m",
                     name_of(how.alignment), how.length_m);
}

Head ate_head(const char* title) {
  return {.title = title, .key = "ate_rmse_m", .decimals = 9, .unit = "m"};
}

Head completion_head() {
  return {.title = "completion",
          .key = "completion",
          .decimals = 9,
          .unit = "%",
          .scale = 100,
          .more_is_better = true};
}

}  // namespace leviosim::tools
