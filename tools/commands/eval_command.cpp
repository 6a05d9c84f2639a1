// `leviosim eval`: how far an estimated trajectory lies from the ground truth.
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/printable.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/html_report/page.h"
#include "tools/app/record/statistics.h"
#include "tools/app/report/accuracy_text.h"
#include "tools/app/table/terminal_table.h"
#include "tools/commands/commands.h"
#include "traces/trajectories/association.h"
#include "traces/trajectories/attitude_errors.h"
#include "traces/trajectories/evaluation.h"
#include "traces/trajectories/trajectory_alignment.h"
#include "traces/trajectories/trajectory_errors.h"
#include "traces/trajectories/trajectory_file.h"

namespace leviosim::tools {
namespace {

using traces::Evaluation;
using traces::RelativeErrors;
using traces::TrajectoryFile;

/// The length over which relative errors are given unless others are asked for. [m]
constexpr double kDefaultLength = 40;

struct EvalOptions {
  std::string estimate;
  std::string truth;
  std::string align = "se3";
  std::string max_dt = "10ms";
  std::vector<std::string> also;  ///< further estimates
  std::vector<std::string> relative;
  std::string expected;
  std::string format;
  std::string times;
  std::string json;
  std::string report;
  bool force = false;
};

struct EvalRequest {
  traces::ReadOptions read;
  traces::EvaluationOptions evaluation;  ///< stamps are those of the files
  std::vector<double> lengths_m;         ///< rising, each once
  std::optional<outputs::OutputFile> json;
  std::optional<outputs::OutputFile> report;
};

/// @returns whether the text ended in it
bool remove_suffix(std::string& text, std::string_view suffix) {
  if (!text.ends_with(suffix)) return false;
  text.resize(text.size() - suffix.size());
  return true;
}

std::vector<double> parse_lengths(const std::vector<std::string>& words) {
  std::vector<double> lengths;
  for (const std::string& word : words) {
    std::istringstream list(word + ',');  // "1,2" is two of them, and "1," one and a fault
    for (std::string length; std::getline(list, length, ',');)
      lengths.push_back(parse_positive("--relative", length));
  }
  if (lengths.empty()) lengths.push_back(kDefaultLength);
  std::sort(lengths.begin(), lengths.end());
  lengths.erase(std::unique(lengths.begin(), lengths.end()), lengths.end());
  return lengths;
}

outputs::OutputRequest output(const EvalOptions& options, const char* option,
                              const std::string& file) {
  outputs::OutputRequest request{.option = option,
                                 .path = file,
                                 .replace = options.force,
                                 .inputs = {options.estimate, options.truth, options.times}};
  request.inputs.insert(request.inputs.end(), options.also.begin(), options.also.end());
  return request;
}

/// Told from each other as files, not as names.
void claim_outputs(const EvalOptions& options, EvalRequest& request) {
  request.json = claimed_file(output(options, "--json", options.json));
  request.report = claimed_file(output(options, "--report", options.report));
  expect_different(request.report, "--report", request.json, "--json");
}

/// Nanoseconds of "10ms", "0.01s" or "10", which is milliseconds too; from 0 to an hour.
/// @throws InputError for anything else
std::int64_t parse_tolerance(const std::string& option, const std::string& text) {
  constexpr double kMostNs = 3600e9;
  std::string number = text;
  double ns_per_unit = 1e6;
  if (!remove_suffix(number, "ms") && remove_suffix(number, "s")) ns_per_unit = 1e9;
  double value = 0;
  if (!base::parse_number(number, value) || value < 0 || value * ns_per_unit > kMostNs)
    throw InputError(fmt::format("{} '{}': expected a time such as 10ms or 0.01s, at most an hour",
                                 option, text));
  return std::llround(value * ns_per_unit);
}

void add_eval_options(CLI::App& command, EvalOptions& options) {
  command.add_option("EST", options.estimate, "estimated trajectory: a file or a run folder");
  command.add_option("GT", options.truth, "ground truth: a file, or a folder of ASL or TUM");
  const TextOptions add{command};
  add("--also", options.also, "EST",
      "another estimate of the same flight, repeatable: a row for each, side by side");
  add("--align", options.align, "KIND",
      "alignment to the truth: se3, sim3, posyaw (gravity is known, z up) or none [se3]");
  add("--max-dt", options.max_dt, "TIME",
      "largest time from a pose to the nearest true one: 10ms, 0.01s, or a number of ms [10ms]");
  add("--relative", options.relative, "M",
      "lengths of sub-trajectories in metres: 10,40; repeatable [40]");
  add("--expected", options.expected, "N",
      "poses of a complete trajectory, such as the frames fed in [those of the truth's duration]");
  add("--format", options.format, "FORMAT",
      "format of both files: tum, euroc or kitti [as they look]");
  add("--times", options.times, "FILE", "time stamps of KITTI files, seconds, one a line");
  command
      .add_option("--json", options.json,
                  "write the figures to a file; without one, at the end, print them as JSON")
      ->type_name("FILE")
      ->expected(0, 1);
  add("--report", options.report, "FILE.html",
      "page to write, for a browser: views from top and side, and errors over time");
  command.add_flag("--force", options.force, "replace these files");
}

/// @throws InputError for anything that is not understood, missing, or cannot be written
EvalRequest make_eval_request(const CLI::App& command, const EvalOptions& options) {
  require(command, "EST", "an estimated trajectory: a TUM, EuRoC or KITTI file, or a run folder");
  require(command, "GT", "the ground truth: a TUM, EuRoC or KITTI file, or a folder of ASL or TUM");
  EvalRequest request;
  request.evaluation.alignment = traces::parse_alignment(options.align);
  request.evaluation.max_gap_ns = parse_tolerance("--max-dt", options.max_dt);
  if (command.count("--expected") > 0)
    request.evaluation.expected_poses = static_cast<std::size_t>(
        parse_whole("--expected", options.expected, 1, std::numeric_limits<std::int32_t>::max()));
  request.lengths_m = parse_lengths(options.relative);
  if (command.count("--format") > 0)
    request.read.format = traces::parse_trajectory_format(options.format);
  request.read.times = options.times;
  claim_outputs(options, request);
  return request;
}

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
  list.add("accuracy.longest_gap", "s", "longest time between successive matched poses",
           value_of(accuracy.evaluation.longest_gap_s));
  list.add("accuracy.scale", "1", "scale that the alignment applied to the estimate",
           rounded(accuracy.evaluation.alignment.scale));
  for (const RelativeErrors& errors : accuracy.relative)
    add_relative(list, accuracy.evaluation, errors);
  return statistics_document(list.rows(), {{"estimate", file_json(pair.estimate)},
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

/// As it was named, but of a path only what tells it from the others; of a run folder its own name.
std::string short_name(const Evaluated& one, const std::vector<Evaluated>& all) {
  const auto name = [](const Evaluated& e) {
    const std::filesystem::path file = e.pair.estimate.file;
    const bool is_of_run = file.filename() == "trajectory.tum" && file.has_parent_path();
    return (is_of_run ? file.parent_path() : file).lexically_normal().filename().string();
  };
  const auto same = std::count_if(all.begin(), all.end(),
                                  [&](const Evaluated& e) { return name(e) == name(one); });
  return printable(same > 1 || name(one).empty() ? one.pair.estimate.file.string() : name(one));
}

/// A row for each estimate, in the order in which they were named.
std::string side_by_side(const std::vector<Evaluated>& all) {
  using E = const Evaluated&;
  const auto fixed = [](auto of, int decimals) {
    return [=](E e) { return figure_text(of(e.accuracy.evaluation), decimals); };
  };
  const auto length = [](auto of) {
    return [=](E e) { return metres_text(of(e.accuracy.evaluation), 4); };
  };
  const auto degrees = [](double traces::AttitudeErrors::*error) {
    return [error](E e) {
      const std::optional<traces::AttitudeErrors> found = attitude_errors(e.accuracy.evaluation);
      return figure_text(found ? std::optional(*found.*error) : std::nullopt, 2);
    };
  };
  Columns<Evaluated> table{
      {{"estimate", kLeft}, [&](E e) { return short_name(e, all); }},
      {{"ATE m"}, length([](const Evaluation& e) { return e.translation.rmse; })},
      {{"median"}, length([](const Evaluation& e) { return e.translation.median; })},
      {{"worst"}, length([](const Evaluation& e) { return e.translation.max; })},
      {{"tilt °"}, degrees(&traces::AttitudeErrors::tilt_rmse_deg)},
      {{"heading °"}, degrees(&traces::AttitudeErrors::heading_rmse_deg)},
      {{"scale"}, fixed([](const Evaluation& e) { return e.alignment.scale; }, 4)},
      {{"poses"}, [](E e) { return e.accuracy.evaluation.matched; }},
      {{"complete %"}, fixed([](const Evaluation& e) { return 100 * e.completion; }, 1)}};
  const std::vector<RelativeErrors>& lengths = all.front().accuracy.relative;
  for (std::size_t i = 0; i < lengths.size(); ++i)
    table.push_back({{fmt::format("drift over {:g} m %", lengths[i].length_m)}, [i](E e) {
                       const RelativeErrors& errors = e.accuracy.relative[i];
                       return errors.count > 0 ? figure_text(errors.translation.mean, 3) : kNothing;
                     }});
  return terminal_text(table_of(table, all));
}

/// The least error, with the share of the path that it is.
std::string conclusion(const std::vector<Evaluated>& all) {
  const Evaluated& best =
      *std::min_element(all.begin(), all.end(), [](const Evaluated& a, const Evaluated& b) {
        return a.accuracy.evaluation.translation.rmse < b.accuracy.evaluation.translation.rmse;
      });
  const Evaluation& e = best.accuracy.evaluation;
  std::string text =
      fmt::format("in short: {}: {} RMSE", short_name(best, all), metres(e.translation.rmse, 3));
  if (e.path_length_m > 0 && e.translation.rmse < kDiverged_m)
    text += fmt::format(", {:.2f} % of the path", 100 * e.translation.rmse / e.path_length_m);
  return text;
}

std::string after(const EvalOptions& options) {
  std::string also;
  for (const std::string& estimate : options.also) also += " --also " + shell_word(estimate);
  return fmt::format("leviosim eval {} {}{} --report errors.html", shell_word(options.estimate),
                     shell_word(options.truth), also);
}

/// One estimate: its figures. Several: a list of such documents.
std::string json_of(const std::vector<Evaluated>& all, const EvalRequest& request) {
  if (all.size() == 1) return json_lines(figures(all[0].pair, request, all[0].accuracy)) + '\n';
  Json document{{"format", "leviosim evaluations"}, {"version", 1}};
  document["evaluations"] = Json::array();
  for (const Evaluated& one : all)
    document["evaluations"].push_back(figures(one.pair, request, one.accuracy));
  return json_text(document, 1) + '\n';
}

/// What the page shows of an estimate, in the words of the page of a run.
Json shown(const Evaluated& one, const std::vector<Evaluated>& all) {
  const Evaluation& e = one.accuracy.evaluation;
  const bool timed = one.pair.estimate.stamps == traces::Stamps::time;
  Json errors;
  for (const traces::MatchedPose& pose : e.poses) {
    const auto time = static_cast<double>(timed ? pose.t_ns - e.poses.front().t_ns : pose.t_ns);
    errors["t_s"].push_back(timed ? time * 1e-9 : time);
    errors["position_error_m"].push_back(translation_error(pose));
    for (int axis = 0; axis < 3; ++axis) {
      errors[fmt::format("estimate_{}_m", "xyz"[axis])].push_back(
          pose.estimate.translation()[axis]);
      errors[fmt::format("truth_{}_m", "xyz"[axis])].push_back(pose.truth.translation()[axis]);
    }
  }
  std::string sentence = fmt::format("Absolute trajectory error {:.3f} m RMSE ({:.3f} m at worst)",
                                     e.translation.rmse, e.translation.max);
  if (const auto attitude = attitude_errors(e)) {
    sentence += fmt::format(", tilt {:.2f}°, heading {:.2f}° RMSE", attitude->tilt_rmse_deg,
                            attitude->heading_rmse_deg);
    errors["tilt_error_deg"] = attitude->tilts_deg;
    for (const double heading : attitude->headings_deg)
      errors["heading_error_deg"].push_back(std::abs(heading));
  }
  return {{"name", short_name(one, all)},
          {"sentence", std::move(sentence)},
          {"protocol", e.protocol},
          {"time", timed ? "s since the first pose" : "number of the pose"},
          {"tables", {{"errors", std::move(errors)}}}};
}

Json page_of(const std::vector<Evaluated>& all) {
  Json data =
      report_json(all.size() == 1 ? "A trajectory beside its truth"
                                  : fmt::format("{} trajectories beside their truth", all.size()),
                  Json::array());
  data["truth"] = printable(all.front().pair.truth.file.string());
  for (const Evaluated& one : all) data["evaluations"].push_back(shown(one, all));
  return data;
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
           {request.report, html_page(page_of(all)), "report"}},
          text);
}

}  // namespace

Command add_eval_command(CLI::App& app, const Arguments&) {
  CLI::App* command = app.add_subcommand("eval", "Compare a trajectory with the ground truth");
  const auto options = std::make_shared<EvalOptions>();
  add_eval_options(*command, *options);
  add_examples(*command,
               {"leviosim eval recorded flight --relative 0.5 --report errors.html",
                "leviosim eval golden flight --align sim3 --relative 0.5 --also recorded"});
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
