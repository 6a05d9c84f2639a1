#include "tools/batch/run_outcome.h"

#include "tools/run/statistic_list.h"
#include "traces/relative_error.h"

namespace leviosim::tools {
namespace {

constexpr const char* kFormat = "leviosim run outcome 1";

std::optional<double> optional_number(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

}  // namespace

RunOutcome measure(const traces::Trajectory& estimate, const traces::Trajectory& truth,
                   const Measure& how) {
  RunOutcome outcome;
  outcome.frames = estimate.size();
  try {
    const traces::Evaluation evaluation = traces::evaluate(
        estimate, truth, {.alignment = how.alignment, .expected_poses = estimate.size()});
    const traces::RelativeErrors relative = traces::relative_errors(evaluation, how.length_m);
    outcome.ate_m = evaluation.translation.rmse;
    if (relative.count > 0) outcome.relative_percent = relative.translation.mean;
    outcome.sub_trajectories = relative.count;
    outcome.matched = evaluation.matched;
    outcome.completion = evaluation.completion;
    outcome.path_m = evaluation.path_length_m;
    outcome.protocol = evaluation.protocol;
  } catch (const traces::NotComparable& failure) {
    outcome.failure = failure.what();
  }
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
  return json.dump() + '\n';
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
    return outcome;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace leviosim::tools
