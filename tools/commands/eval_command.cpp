#include "tools/commands/eval_command.h"

#include <fmt/core.h>

#include <memory>

#include "sim/base/error.h"
#include "tools/app/cli/terminal.h"
#include "tools/app/evaluation/eval_options.h"
#include "tools/app/evaluation/trajectory_plot.h"
#include "tools/app/report/accuracy.h"

namespace leviosim::tools {
namespace {

using traces::Evaluation;
using traces::RelativeErrors;
using traces::TrajectoryFile;

struct Accuracy {
  Evaluation evaluation;
  std::vector<RelativeErrors> relative;
};

Accuracy measure(const traces::TrajectoryPair& pair, EvalRequest& request) {
  request.evaluation.stamps = pair.estimate.stamps;
  Accuracy accuracy;
  accuracy.evaluation = evaluate(pair.estimate.poses, pair.truth.poses, request.evaluation);
  const std::size_t expected = request.evaluation.expected_poses;
  if (expected > 0 && accuracy.evaluation.matched > expected)
    throw InputError(fmt::format("--expected {}: fewer than the {} poses that were matched",
                                 expected, accuracy.evaluation.matched));
  for (const double length : request.lengths_m)
    accuracy.relative.push_back(relative_errors(accuracy.evaluation, length));
  return accuracy;
}

std::string file_line(const char* what, const TrajectoryFile& trajectory) {
  return fmt::format("{:<14}{} ({}, {} poses)\n", what, printable(trajectory.file.string()),
                     name_of(trajectory.format), trajectory.poses.size());
}

std::string report(const traces::TrajectoryPair& pair, const EvalRequest& request,
                   const Accuracy& accuracy) {
  std::string text = file_line("estimate:", pair.estimate) +
                     file_line("ground truth:", pair.truth) + ate_text(accuracy.evaluation);
  if (request.evaluation.alignment == traces::Alignment::sim3)
    text += fmt::format("     scale of the estimate: times {:.6g}\n",
                        accuracy.evaluation.alignment.scale);
  return text + relative_text(accuracy.evaluation, accuracy.relative);
}

Json file_json(const TrajectoryFile& trajectory) {
  return {{"file", trajectory.file.string()},
          {"format", name_of(trajectory.format)},
          {"poses", trajectory.poses.size()}};
}

Json protocol_json(const EvalRequest& request) {
  const traces::EvaluationOptions& options = request.evaluation;
  const bool timed = options.stamps == traces::Stamps::time;
  return {{"alignment", name_of(options.alignment)},
          {"matched_by", timed ? "time, truth interpolated" : "pose number"},
          {"max_dt_ms", timed ? Json(static_cast<double>(options.max_gap_ns) * 1e-6) : Json()},
          {"expected_poses", options.expected_poses > 0 ? Json(options.expected_poses) : Json()},
          {"relative_lengths_m", request.lengths_m}};
}

std::string figures_text(const traces::TrajectoryPair& pair, const EvalRequest& request,
                         const Accuracy& accuracy) {
  StatisticList list;
  add_ate(list, accuracy.evaluation);
  list.add("accuracy.longest_gap", "s", "between successive matched poses",
           value_of(accuracy.evaluation.longest_gap_s));
  list.add("accuracy.scale", "1", "that the alignment applied to the estimate",
           rounded(accuracy.evaluation.alignment.scale));
  for (const RelativeErrors& errors : accuracy.relative)
    add_relative(list, accuracy.evaluation, errors);
  return statistics_document_text(
      statistics_document(list.take(), {{"estimate", file_json(pair.estimate)},
                                        {"ground_truth", file_json(pair.truth)},
                                        {"protocol", protocol_json(request)}}));
}

/// @throws InputError that names the file
Accuracy measured(const traces::TrajectoryPair& pair, EvalRequest& request,
                  const EvalOptions& options) {
  try {
    return measure(pair, request);
  } catch (const traces::NotComparable& error) {
    throw InputError(
        fmt::format("{} against {}: {}", options.estimate, options.truth, error.what()));
  }
}

void run(const CLI::App& command, const EvalOptions& options) {
  EvalRequest request = make_eval_request(command, options);
  const traces::TrajectoryPair pair = read_pair(options.estimate, options.truth, request.read);
  const Accuracy accuracy = measured(pair, request, options);
  publish({{request.json, figures_text(pair, request, accuracy), "figures"},
           {request.plot, trajectory_plot(pair, accuracy.evaluation), "plot"}},
          report(pair, request, accuracy));
}

}  // namespace

Command add_eval_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("eval", "Compare a trajectory with the ground truth");
  const auto options = std::make_shared<EvalOptions>();
  add_eval_options(*command, *options);
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
