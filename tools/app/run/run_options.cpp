#include "tools/app/run/run_options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <limits>

#include "platform_models/loader/parameter_units.h"
#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/workload_options.h"
#include "traces/datasets/camera_model.h"
#include "traces/datasets/image_file.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

constexpr std::int64_t kLargestSide = 16384;

/// A native run has no chip, so options about one are a misunderstanding.
void refuse_chip_options(const RunOptions& options, const RunRequest& request) {
  const auto refuse_if = [](bool is_given, const std::string& option) {
    if (is_given)
      throw InputError(fmt::format("run: --native computes without a chip; leave out {}", option));
  };
  refuse_if(!options.platform.empty(), "--platform");
  refuse_if(!options.cores.empty(), "--cores");
  refuse_if(options.record, "--record");
  refuse_if(options.film, "--film");
  refuse_if(!options.camera_fps.empty(), "--fps");
  refuse_if(!options.deadline.empty(), "--deadline");
  for (const std::string& text : request.overrides) refuse_if(true, "--set " + text);
}

void add_workload_options(CLI::App& command, RunOptions& options, const std::string& by_default) {
  const TextOptions add{command};
  add("--data", options.data, "DIR|synthetic",
      "recording (EuRoC, TUM, KITTI), or the synthetic flight" + by_default);
  add("--frames", options.frames, "A:B", "frames, B exclusive [all]");
  add("--profile", options.profile, "NAME",
      fmt::format("profile of the workload [{}]", options.profile));
  add("--seed", options.seed, "N", "seed of the workload's random draws [1]");
  command.add_flag("--quiet", options.quiet, "no progress");
  command.get_option("--set")->description(
      "parameter of the chip, or of the workload: workload.… (leviosim workload); repeatable");
}

/// What does not depend on the chip.
RunRequest make_workload_request(const RunOptions& options) {
  RunRequest request;
  request.native = options.native;
  if (options.seed.find(',') != std::string::npos)
    throw InputError(fmt::format(
        "--seed '{0}': a run has one seed; expected a whole number, or a sweep with the points "
        "grid: {{ seed: [{0}] }} (leviosim sweep --help)",
        options.seed));
  request.seed = static_cast<std::uint32_t>(
      parse_whole("--seed", options.seed, 0, std::numeric_limits<std::uint32_t>::max()));
  request.profile = options.profile;
  vio::expect_profile(options.profile);
  SplitOverrides overrides = split_overrides(options.overrides);
  request.workload = parse_workload_overrides(overrides.workload);
  request.overrides = std::move(overrides.chip);
  request.image_size = parse_size(options.size);
  if (!options.frames.empty()) request.frames = traces::parse_frame_range(options.frames);
  return request;
}

constexpr const char* kWait = "workload.initialisation.wait";

/// How long poses wait, as --initial-delay and --online say it, among the workload's parameters.
void set_initial_wait(const RunOptions& options, RunRequest& request) {
  if (options.initial_delay.empty() && !options.online) return;
  const char* const option = options.online ? "--online" : "--initial-delay";
  if (options.online && !options.initial_delay.empty())
    throw InputError("run: --online and --initial-delay exclude each other; expected one of them");
  const vio::Parameter& wait = workload_parameter(option, kWait);
  for (const vio::Assignment& set : request.workload)
    if (set.parameter == &wait)
      throw InputError(fmt::format("{}: -p {} says the same; expected one of them", option, kWait));
  double seconds = 0;
  if (!options.online && (!base::parse_number(options.initial_delay, seconds) ||
                          seconds < wait.low || seconds > wait.high))
    throw InputError(fmt::format("--initial-delay '{}': expected a number from {:g} to {:g}, in s",
                                 options.initial_delay, wait.low, wait.high));
  if (profile_of(request).initialises())
    request.workload.push_back({&wait, seconds});
  else if (seconds > 0)
    throw InputError(fmt::format(
        "--initial-delay: profile '{}' has no initialisation that would correct poses; expected "
        "--profile next",
        request.profile));
}

void resolve_chip(const RunOptions& options, RunRequest& request) {
  request.platform = platform::resolve_platform(options.platform, request.overrides);
  request.cores = cores_of(options, request.platform.config.cluster);
}

}  // namespace

void add_chip_options(CLI::App& command, RunOptions& options, const std::string& by_default) {
  const TextOptions add{command};
  add("--platform", options.platform, "NAME|FILE",
      "chip: a name (leviosim platforms) or a file" + by_default);
  add("-p,--set", options.overrides, "PATH=VALUE", "parameter of the chip; repeatable");
  add("--cores", options.cores, "N", "worker cores [the chip's]");
}

void add_out_options(CLI::App& command, RunOptions& options) {
  TextOptions{command}("--out", options.out, "DIR", "folder for the results; must be new or empty");
  command.add_flag("--force", options.force, "replace the results of an earlier run");
}

int cores_of(const RunOptions& options, const sim::ClusterConfig& cluster) {
  if (options.cores.empty()) return cluster.workers;
  return static_cast<int>(
      parse_whole("--cores", options.cores, 1, cluster.workers,
                  ", the chip's cluster.workers (-p cluster.workers=N sets it)"));
}

void add_run_options(CLI::App& command, RunOptions& options) {
  const TextOptions add{command};
  add_chip_options(command, options, " [gap9]");
  command.add_flag("--native", options.native, "no chip, no timing: the golden model");
  add_workload_options(command, options, " [synthetic]");
  add("--size", options.size, "WxH", "image size [160x120]");
  add("--fps", options.camera_fps, "F",
      "closed loop: a camera of F frames/s that loses frames [the recorded rate]");
  add("--deadline", options.deadline, "drop|queue",
      "closed loop: fate of a frame that finds the front end busy [drop]");
  add("--initial-delay", options.initial_delay, "S",
      "longest wait, in seconds, of the first poses for the map's alignment, which corrects them "
      "[2; 0 "
      "for profiles without an initialisation]");
  command.add_flag("--online", options.online, "give every pose at once: the first are guesses");
  command.add_flag("--record", options.record, "leave a trace of the work, for leviosim replay");
  command.add_flag("--film", options.film,
                   "with --record: also images and features, some 4 kB a frame, for report "
                   "--interactive");
  add_out_options(command, options);
  command.get_option("--out")->description(
      "folder for the results; must be new or empty [leviosim-run, or with the next free number]");
}

void set_run_defaults(RunOptions& options) {
  if (options.platform.empty() && !options.native) options.platform = "gap9";
  if (options.data.empty()) options.data = "synthetic";
  const std::string name = "leviosim-run";
  if (!options.out.empty()) return;
  options.out = name;
  for (int n = 2; base::exists(options.out); ++n) options.out = fmt::format("{}-{}", name, n);
}

void add_chip_run_options(CLI::App& command, RunOptions& options) {
  options.platform = "gap9";
  options.data = "synthetic";
  add_chip_options(command, options, " [gap9]");
  add_workload_options(command, options, " [synthetic]");
}

double parse_frame_rate(const std::string& text) {
  double rate = 0;
  if (!base::parse_number(text, rate) || rate < traces::kLeastHz || rate > traces::kMostHz)
    throw InputError(fmt::format("--fps '{}': expected a number above 0, from {} to {}", text,
                                 traces::kLeastHz, traces::kMostHz));
  return rate;
}

std::optional<CameraRequest> parse_camera(const std::string& fps, const std::string& deadline) {
  if (fps.empty() && deadline.empty()) return std::nullopt;
  CameraRequest camera;
  if (!fps.empty()) camera.fps = parse_frame_rate(fps);
  if (!deadline.empty()) camera.deadline = soc::parse_deadline(deadline);
  return camera;
}

traces::ImageSize parse_size(const std::string& text) {
  const auto x = text.find('x');
  const auto side = [](const std::string& digits) {
    return static_cast<int>(parse_whole("--size", digits, 1, kLargestSide));
  };
  try {
    if (x != std::string::npos) return {side(text.substr(0, x)), side(text.substr(x + 1))};
  } catch (const InputError&) {
    // names one side alone
  }
  throw InputError(
      fmt::format("--size '{}': expected WxH, two whole numbers from 1 to {}, e.g. 160x120", text,
                  kLargestSide));
}

RunRequest make_request(const RunOptions& options) {
  RunRequest request = make_workload_request(options);
  set_initial_wait(options, request);
  if (options.native) {
    refuse_chip_options(options, request);
  } else {
    resolve_chip(options, request);
    request.camera = parse_camera(options.camera_fps, options.deadline);
    if (request.camera && options.record)
      throw InputError(
          "run: --record is for open loops, whose trace holds the work of every frame; with "
          "--fps or --deadline, frames are dropped as the chip's speed has it");
  }
  if (options.film && !options.record)
    throw InputError(
        "run: --film goes with the work that a page times anew; expected --record, too");
  if (options.film && vio::other_profile(options.profile) != nullptr)
    throw InputError(fmt::format(
        "run: --film draws the features of an odometry, and workload '{}' has none; expected it "
        "without --film",
        options.profile));
  return request;
}

RunRequest make_chip_request(const RunOptions& options) {
  RunRequest request = make_workload_request(options);
  resolve_chip(options, request);
  return request;
}

}  // namespace leviosim::tools
