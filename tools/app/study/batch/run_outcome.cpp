#include "tools/app/study/batch/run_outcome.h"

#include <array>
#include <utility>

#include "sim/base/error.h"
#include "tools/app/report/statistic_list.h"
#include "tools/app/result/energy.h"
#include "tools/app/result/summary.h"
#include "traces/trajectories/relative_error.h"

namespace leviosim::tools {
namespace {

constexpr const char* kFormat = "leviosim run outcome 2";

std::optional<double> optional_number(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

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

Json banded_json(const std::optional<Banded>& figure) {
  if (!figure) return nullptr;
  return {figure->value, figure->low, figure->high};
}

std::optional<Banded> parse_banded(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return Banded{json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

/// The whole numbers of a loop, by name.
struct LoopField {
  const char* name;
  std::int64_t& (*of)(LoopOutcome&);
};
constexpr std::array kLoopFields{
    LoopField{"arrived", [](LoopOutcome& l) -> std::int64_t& { return l.camera.arrived; }},
    LoopField{"processed", [](LoopOutcome& l) -> std::int64_t& { return l.camera.processed; }},
    LoopField{"dropped", [](LoopOutcome& l) -> std::int64_t& { return l.camera.dropped; }},
    LoopField{"late", [](LoopOutcome& l) -> std::int64_t& { return l.camera.late; }},
    LoopField{"waited", [](LoopOutcome& l) -> std::int64_t& { return l.camera.waited; }},
    LoopField{"p50_ns", [](LoopOutcome& l) -> std::int64_t& { return l.camera.latency.p50_ns; }},
    LoopField{"p95_ns", [](LoopOutcome& l) -> std::int64_t& { return l.camera.latency.p95_ns; }},
    LoopField{"p99_ns", [](LoopOutcome& l) -> std::int64_t& { return l.camera.latency.p99_ns; }},
    LoopField{"max_ns", [](LoopOutcome& l) -> std::int64_t& { return l.camera.latency.max_ns; }},
};

Json loop_json(std::optional<LoopOutcome> loop) {
  if (!loop) return nullptr;
  Json json;
  for (const LoopField& field : kLoopFields) json[field.name] = field.of(*loop);
  json["most_found"] = loop->camera.most_found;
  json["power_w"] = banded_json(loop->power_w);
  json["frame_j"] = banded_json(loop->frame_j);
  return json;
}

std::optional<LoopOutcome> parse_loop(const Json& json) {
  if (json.is_null()) return std::nullopt;
  LoopOutcome loop;
  for (const LoopField& field : kLoopFields)
    field.of(loop) = json.at(field.name).get<std::int64_t>();
  loop.camera.most_found = json.at("most_found").get<int>();
  loop.power_w = parse_banded(json.at("power_w"));
  loop.frame_j = parse_banded(json.at("frame_j"));
  return loop;
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
  } catch (const InputError& failure) {
    outcome.failure = failure.what();
  }
  return outcome;
}

RunOutcome outcome_of(const RunResult& run, const traces::Trajectory& truth, const Measure& how) {
  constexpr std::size_t kFewest = 3;
  const std::size_t expected = expected_poses(run);
  RunOutcome outcome;
  if (std::string why = why_incomparable(run); !why.empty())
    outcome.failure = std::move(why);
  else if (run.camera && run.trajectory.size() < kFewest)
    outcome.failure = "fewer than three frames were processed";
  else
    outcome = measure(run.trajectory, truth, how, expected);
  outcome.frames = expected;
  if (run.camera) outcome.loop = loop_of(run);
  return outcome;
}

std::string to_text(const RunOutcome& outcome) {
  Json json;
  json["format"] = kFormat;
  json["failure"] = outcome.failure;
  json["ate_m"] = value_of(outcome.ate_m);
  json["relative_percent"] = value_of(outcome.relative_percent);
  json["sub_trajectories"] = outcome.sub_trajectories;
  json["frames"] = outcome.frames;
  json["matched"] = outcome.matched;
  json["completion"] = outcome.completion;
  json["path_m"] = outcome.path_m;
  json["protocol"] = outcome.protocol;
  json["loop"] = loop_json(outcome.loop);
  return json_text(json) + '\n';
}

std::optional<RunOutcome> parse_outcome(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    if (json.at("format") != kFormat) return std::nullopt;
    RunOutcome outcome;
    outcome.failure = json.at("failure").get<std::string>();
    outcome.ate_m = optional_number(json.at("ate_m"));
    outcome.relative_percent = optional_number(json.at("relative_percent"));
    outcome.sub_trajectories = json.at("sub_trajectories").get<std::size_t>();
    outcome.frames = json.at("frames").get<std::size_t>();
    outcome.matched = json.at("matched").get<std::size_t>();
    outcome.completion = json.at("completion").get<double>();
    outcome.path_m = json.at("path_m").get<double>();
    outcome.protocol = json.at("protocol").get<std::string>();
    outcome.loop = parse_loop(json.at("loop"));
    return outcome;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace leviosim::tools
