// Options of `leviosim eval`, as words and as what they mean.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/app/cli/command_line.h"
#include "tools/app/cli/outputs.h"
#include "traces/trajectories/evaluation.h"
#include "traces/trajectories/trajectory_file.h"

namespace leviosim::tools {

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
  std::string plot;
  bool force = false;
};

struct EvalRequest {
  traces::ReadOptions read;
  traces::EvaluationOptions evaluation;  ///< stamps are those of the files
  std::vector<double> lengths_m;         ///< rising, each once
  std::optional<outputs::OutputFile> json;
  std::optional<outputs::OutputFile> plot;
};

void add_eval_options(CLI::App& command, EvalOptions& options);

/// @throws InputError for anything that is not understood, missing, or cannot be written
EvalRequest make_eval_request(const CLI::App& command, const EvalOptions& options);

/// Nanoseconds of "10ms", "0.01s" or "10", which is milliseconds too; from 0 to an hour.
/// @throws InputError for anything else
std::int64_t parse_tolerance(const std::string& option, const std::string& text);

// A trajectory and its errors as one picture: views from top (x, y) and side (x, z) at the same
// scale, with the aligned estimate coloured by its error over the truth in grey; translation,
// tilt and heading error over time. World z is up.

/// The text of an SVG file; the same inputs give the same bytes. `evaluation` is that of the pair.
std::string trajectory_plot(const traces::TrajectoryPair& pair,
                            const traces::Evaluation& evaluation);

}  // namespace leviosim::tools
