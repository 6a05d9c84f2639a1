#include "tools/app/evaluation/eval_options.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "traces/trajectories/alignment.h"

namespace leviosim::tools {
namespace {

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
  if (!options.plot.empty() && std::filesystem::path(options.plot).extension() != ".svg")
    throw InputError(fmt::format("--plot {}: expected a file that ends in .svg", options.plot));
  if (!options.plot.empty() && !options.also.empty())
    throw InputError(
        fmt::format("--plot {}: draws one estimate; expected no --also", options.plot));
  request.json = claimed_file(output(options, "--json", options.json));
  request.plot = claimed_file(output(options, "--plot", options.plot));
  expect_different(request.plot, "--plot", request.json, "--json");
}

}  // namespace

void add_eval_options(CLI::App& command, EvalOptions& options) {
  command.add_option("EST", options.estimate, "estimated trajectory: a file or a run folder");
  command.add_option("GT", options.truth, "ground truth: a file or an ASL folder");
  command
      .add_option("--also", options.also,
                  "another estimate of the same flight, repeatable: a row for each, side by side")
      ->type_name("EST")
      ->take_all()
      ->allow_extra_args(false);
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    command.add_option(name, value, help)->type_name(type);
  };
  add("--align", options.align, "KIND",
      "what is aligned first: se3, sim3, posyaw (gravity is known, z up) or none [se3]");
  add("--max-dt", options.max_dt, "TIME",
      "to the nearest true sample of a matched pose: 10ms, 0.01s, or a number of ms [10ms]");
  command
      .add_option("--relative", options.relative,
                  "lengths of sub-trajectories in metres: 10,40; repeatable [40]")
      ->type_name("M")
      ->take_all()
      ->allow_extra_args(false);
  add("--expected", options.expected, "N",
      "completion is of N poses, e.g. the frames fed in [of the ground truth's duration]");
  add("--format", options.format, "FORMAT", "of both files: tum, euroc or kitti [as they look]");
  add("--times", options.times, "FILE", "time stamps of KITTI files, seconds, one a line");
  command
      .add_option("--json", options.json,
                  "write the figures to a file; without one, at the end, print them as JSON")
      ->type_name("FILE")
      ->expected(0, 1);
  add("--plot", options.plot, "FILE.svg", "draw views from top and side, and errors over time");
  command.add_flag("--force", options.force, "replace these files");
}

EvalRequest make_eval_request(const CLI::App& command, const EvalOptions& options) {
  require(command, "EST", "an estimated trajectory: a TUM, EuRoC or KITTI file, or a run folder");
  require(command, "GT", "the ground truth: a TUM, EuRoC or KITTI file, or an ASL folder");
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

}  // namespace leviosim::tools
