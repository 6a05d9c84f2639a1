// `leviosim eval`: how far an estimated trajectory lies from the ground truth.
#include "tools/commands/commands.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/printable_text.h"
#include "tools/app/evaluation/evaluation.h"
#include "tools/app/report/run_summary.h"
#include "tools/app/report/text_table.h"
#include "traces/trajectories/trajectory_errors.h"

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

Json figures(const traces::TrajectoryPair& pair, const EvalRequest& request,
             const Accuracy& accuracy) {
  StatisticList list;
  add_ate(list, accuracy.evaluation, attitude_errors(accuracy.evaluation));
  list.add("accuracy.longest_gap", "s", "between successive matched poses",
           value_of(accuracy.evaluation.longest_gap_s));
  list.add("accuracy.scale", "1", "that the alignment applied to the estimate",
           rounded(accuracy.evaluation.alignment.scale));
  for (const RelativeErrors& errors : accuracy.relative)
    add_relative(list, accuracy.evaluation, errors);
  return statistics_document(list.take(), {{"estimate", file_json(pair.estimate)},
                                           {"ground_truth", file_json(pair.truth)},
                                           {"protocol", protocol_json(request)}});
}

/// An estimate, the truth, and how far they lie apart.
struct Evaluated {
  traces::TrajectoryPair pair;
  Accuracy accuracy;
};

/// @throws InputError that names the file
Evaluated evaluated(const std::string& estimate, const EvalOptions& options, EvalRequest& request) {
  Evaluated result;
  result.pair = read_pair(estimate, options.truth, request.read);
  try {
    result.accuracy = measure(result.pair, request);
  } catch (const traces::NotComparable& error) {
    throw InputError(fmt::format("{} against {}: {}", estimate, options.truth, error.what()));
  }
  return result;
}

/// A row for each estimate, in the order in which they were named.
std::string side_by_side(const std::vector<Evaluated>& all) {
  std::vector<TextTable::Column> columns{{"estimate", TextTable::Align::Left},
                                         {"ATE m"},
                                         {"median"},
                                         {"worst"},
                                         {"tilt °"},
                                         {"heading °"},
                                         {"scale"},
                                         {"poses"},
                                         {"complete %"}};
  for (const RelativeErrors& errors : all.front().accuracy.relative)
    columns.push_back({fmt::format("drift over {:g} m %", errors.length_m)});
  TextTable table(columns);
  for (const auto& [pair, accuracy] : all) {
    const Evaluation& e = accuracy.evaluation;
    const std::optional<traces::AttitudeErrors> attitude = attitude_errors(e);
    const auto degrees = [&](double traces::AttitudeErrors::*error) {
      return attitude ? fmt::format("{:.2f}", *attitude.*error) : "–";
    };
    std::vector<std::string> cells{printable(pair.estimate.file.string()),
                                   fmt::format("{:.4f}", e.translation.rmse),
                                   fmt::format("{:.4f}", e.translation.median),
                                   fmt::format("{:.4f}", e.translation.max),
                                   degrees(&traces::AttitudeErrors::tilt_rmse_deg),
                                   degrees(&traces::AttitudeErrors::heading_rmse_deg),
                                   fmt::format("{:.4f}", e.alignment.scale),
                                   fmt::format("{}", e.matched),
                                   fmt::format("{:.1f}", 100 * e.completion)};
    for (const RelativeErrors& errors : accuracy.relative)
      cells.push_back(errors.count > 0 ? fmt::format("{:.3f}", errors.translation.mean) : "–");
    table.add(std::move(cells));
  }
  return table.str();
}

/// The least error, with the share of the path that it is.
std::string conclusion(const std::vector<Evaluated>& all) {
  const Evaluated& best =
      *std::min_element(all.begin(), all.end(), [](const Evaluated& a, const Evaluated& b) {
        return a.accuracy.evaluation.translation.rmse < b.accuracy.evaluation.translation.rmse;
      });
  const Evaluation& e = best.accuracy.evaluation;
  std::string text =
      fmt::format("in short: {}: {:.3f} m RMSE", printable(best.pair.estimate.file.string()),
                  e.translation.rmse);
  if (e.path_length_m > 0)
    text += fmt::format(", {:.2f} % of the path", 100 * e.translation.rmse / e.path_length_m);
  return text;
}

std::string after(const EvalOptions& options) {
  std::string also;
  for (const std::string& estimate : options.also) also += " --also " + estimate;
  return printable(fmt::format("leviosim eval {} {}{} --plot errors.svg", options.estimate,
                               options.truth, also));
}

/// One estimate: its figures. Several: a list of such documents.
std::string json_of(const std::vector<Evaluated>& all, const EvalRequest& request) {
  if (all.size() == 1)
    return statistics_document_text(figures(all[0].pair, request, all[0].accuracy));
  Json document{{"format", "leviosim evaluations"}, {"version", 1}};
  document["evaluations"] = Json::array();
  for (const Evaluated& one : all)
    document["evaluations"].push_back(figures(one.pair, request, one.accuracy));
  return json_text(document, 1) + '\n';
}

void run(const CLI::App& command, const EvalOptions& options) {
  EvalRequest request = make_eval_request(command, options);
  std::vector<Evaluated> all{evaluated(options.estimate, options, request)};
  for (const std::string& estimate : options.also)
    all.push_back(evaluated(estimate, options, request));
  const auto lines = [&] {
    std::string text;
    for (const Evaluated& one : all) text += report(one.pair, request, one.accuracy);
    const std::string table = all.size() > 1 ? side_by_side(all) : std::string();
    return Printout({text, table}).ending(conclusion(all), {after(options)});
  };
  const bool prints_json = command.count("--json") > 0 && !request.json;
  const Printout text = printout(prints_json, lines, [&] { return json_of(all, request); });
  publish({{request.json, json_of(all, request), "figures"},
           {request.plot, trajectory_plot(all[0].pair, all[0].accuracy.evaluation), "plot"}},
          text);
}

}  // namespace

Command add_eval_command(CLI::App& app, const Words&) {
  CLI::App* command = app.add_subcommand("eval", "Compare a trajectory with the ground truth");
  const auto options = std::make_shared<EvalOptions>();
  add_eval_options(*command, *options);
  add_examples(*command,
               {"leviosim eval recorded flight --relative 0.5 --plot errors.svg",
                "leviosim eval golden flight --align sim3 --relative 0.5 --also recorded"});
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
