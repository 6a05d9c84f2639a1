#include "tools/app/study/tune/tune_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/energy/model.h"
#include "sim/energy/supply.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/workload.h"
#include "tools/app/run/workload_options.h"
#include "traces/recordings/recording.h"

namespace leviosim::tools {
namespace {

constexpr std::size_t kMostValues = 10'000;

constexpr double kMega = 1e6;

[[noreturn]] void refuse(const std::string& option, const std::string& text,
                         const std::string& expected) {
  throw InputError(fmt::format("{} '{}': expected {}", option, text, expected));
}

Hertz parse_megahertz(const std::string& text) {
  constexpr double kMost = 1e5;  // beyond any clock, and small enough to be a whole number of hertz
  double value = 0;
  constexpr std::string_view kUnit = "MHz";
  const std::string number =
      text.ends_with(kUnit) ? text.substr(0, text.size() - kUnit.size()) : text;
  if (!base::parse_number(number, value) || !(value > 0) || value > kMost)
    refuse("--clock", text, "a clock in MHz above 0, such as 240, or a range 100:370:10");
  return Hertz(std::llround(value * kMega));
}

std::vector<Hertz> clock_range(const std::string& text, const std::vector<std::string>& parts) {
  const Hertz first = parse_megahertz(parts[0]);
  const Hertz last = parse_megahertz(parts[1]);
  const Hertz step = parse_megahertz(parts[2]);
  if (last < first)
    refuse("--clock", text, "the lower clock first: LOW:HIGH:STEP; this range is empty");
  if (step < Hertz(1) || (last - first).count() / step.count() >= std::int64_t{kMostValues})
    refuse("--clock", text, fmt::format("no more than {} clocks", kMostValues));
  std::vector<Hertz> clocks;
  for (Hertz clock = first; clock <= last; clock += step) clocks.push_back(clock);
  return clocks;
}

/// The same value twice would only look like more points.
template <class T>
void sort_and_refuse_repetitions(const std::string& option, const std::string& text,
                                 std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  if (std::adjacent_find(values.begin(), values.end()) != values.end())
    refuse(option, text, "every value once");
}

double parse_miss_rate(const std::string& text) {
  double value = 0;
  if (!base::parse_number(text, value) || !(value >= 0) || value > 1)
    refuse("--miss-rate", text, "a share of the frames from 0 to 1, such as 0.05 for 5 %");
  return value;
}

/// What a point of the curve sets itself.
void refuse_operating_points(const RunOptions& options) {
  for (const std::string& text : split_overrides(options.overrides).chip)
    for (const char* path : {"cluster.clock", "controller.clock", "supply.voltage"})
      if (text.rfind(std::string(path) + "=", 0) == 0)
        throw InputError(
            fmt::format("tune: -p {}: clocks are those of --clock, at the lowest voltage that "
                        "allows them; leave it out",
                        text));
}

double checked_recorded_rate(const RunRequest& request, const std::vector<double>& fps) {
  const traces::Dataset data = traces::open_recording(request.data, {.frames = request.frames});
  std::vector<std::int64_t> stamps_ns;
  for (const traces::FrameRef& frame : data.frames) stamps_ns.push_back(frame.t_ns);
  for (const double rate : fps) soc::frames_at(rate, stamps_ns, data.camera.rate_hz);
  return data.camera.rate_hz;
}

/// As it is; from starts that are spread over the first two thirds of the recording, as long as
/// enough of it is left; with a clock 2 % lower and 2 % higher; with a small gyro bias, either way.
void add_perturbations(TunePlan& plan) {
  const std::uint32_t seed = plan.request.seed;
  const std::size_t frames = plan.sequence.frames;
  constexpr double kSmallBias = 1e-4;
  constexpr std::size_t kStarts = 8, kParts = 12, kFewestFrames = 40;
  constexpr std::size_t kAll = 59;  // of which none fails: 95 % of all do not (share_held)
  const auto with = [&](std::string name, auto change) {
    Variation variation{.name = std::move(name), .seed = seed};
    change(variation);
    return variation;
  };
  const auto start = [&](std::size_t later) {
    return with(fmt::format("{} frames later", later), [=](Variation& v) { v.later = later; });
  };
  std::vector<Variation> all{
      with("as it is", [](Variation&) {}), with("clock -2 %", [](Variation& v) { v.clock = 0.98; }),
      with("clock +2 %", [](Variation& v) { v.clock = 1.02; }),
      with("gyro -0.0001 rad/s", [=](Variation& v) { v.gyro_bias = -kSmallBias; }),
      with("gyro +0.0001 rad/s", [=](Variation& v) { v.gyro_bias = kSmallBias; })};
  for (std::size_t k = 1; k <= kStarts; ++k) {
    const std::size_t later = k * frames / kParts;
    if (later + kFewestFrames > frames) break;
    all.push_back(start(later));
  }
  plan.screening = all.size();
  // More starts between the first ones: the fractional parts of multiples of the golden ratio lie
  // apart, however many there are.
  constexpr double kGolden = 0.6180339887498949;
  const auto within = static_cast<double>(frames * kStarts / kParts);
  for (std::size_t k = 1; all.size() < kAll && k <= 2 * kAll; ++k) {
    const double part = kGolden * static_cast<double>(k);
    const auto later = static_cast<std::size_t>(within * (part - std::floor(part)));
    const bool is_new =
        std::none_of(all.begin(), all.end(), [&](const Variation& v) { return v.later == later; });
    if (is_new && later + kFewestFrames <= frames) all.push_back(start(later));
  }
  plan.variations = std::move(all);
}

/// Perturbations for workloads that draw nothing at random while they track, unless seeds are asked
/// for.
void choose_variations(const TuneOptions& options, TunePlan& plan) {
  const bool asks_for_seeds = !options.seed.empty();
  const std::vector<std::uint32_t> seeds =
      parse_seed_list(asks_for_seeds ? options.seed : kTunedSeeds);
  if (options.perturbs && asks_for_seeds && seeds.size() > 1)
    throw InputError("--perturb: perturbs runs of one seed; expected one, such as --seed 1");
  plan.options.seed = fmt::format("{}", seeds.front());
  plan.request = make_chip_request(plan.options);
  plan.perturbs =
      options.perturbs || (!asks_for_seeds && value_of(plan.request, "workload.guided") != 0);
  if (!plan.perturbs)
    for (const std::uint32_t seed : seeds)
      plan.variations.push_back({.name = fmt::format("seed {}", seed), .seed = seed});
  plan.screening = plan.variations.size();
}

}  // namespace

std::vector<Hertz> parse_clocks(const std::string& text) {
  std::vector<Hertz> clocks;
  for (const std::string& item : base::split(text, ',')) {
    const std::vector<std::string> parts = base::split(item, ':');
    if (parts.size() == 1) {
      clocks.push_back(parse_megahertz(item));
    } else if (parts.size() == 3) {
      for (const Hertz clock : clock_range(item, parts)) clocks.push_back(clock);
    } else {
      refuse("--clock", item, "MHz, or a range LOW:HIGH:STEP of them, such as 100:370:10");
    }
  }
  sort_and_refuse_repetitions("--clock", text, clocks);
  return clocks;
}

std::vector<std::uint32_t> parse_seed_list(const std::string& text) {
  std::vector<std::uint32_t> seeds;
  for (const std::string& item : base::split(text, ','))
    seeds.push_back(static_cast<std::uint32_t>(
        parse_whole("--seed", item, 0, std::numeric_limits<std::uint32_t>::max())));
  std::vector<std::uint32_t> sorted = seeds;
  sort_and_refuse_repetitions("--seed", text, sorted);
  return seeds;
}

std::vector<double> parse_rates(const std::string& text) {
  std::vector<double> rates;
  for (const std::string& item : base::split(text, ',')) rates.push_back(parse_frame_rate(item));
  sort_and_refuse_repetitions("--fps", text, rates);
  return rates;
}

ClockSetting setting_for(const sim::ChipConfig& chip, const std::string& name, Hertz clock) {
  const Hertz faster = std::max(chip.cluster.clock, chip.controller.clock);
  const double ratio = static_cast<double>(clock.count()) / static_cast<double>(faster.count());
  ClockSetting setting{clock, {}, {}};
  const auto set = [&](const char* path, Hertz own) {
    const auto scaled = std::llround(static_cast<double>(own.count()) * ratio);
    setting.overrides.push_back(
        fmt::format("{}={:.9g}MHz", path, static_cast<double>(scaled) / kMega));
  };
  set("cluster.clock", chip.cluster.clock);
  set("controller.clock", chip.controller.clock);
  if (!sim::knows_energy(chip)) return setting;
  setting.voltage = sim::lowest_voltage(chip.supply, clock);
  if (!setting.voltage)
    throw InputError(
        fmt::format("--clock: {:g} MHz: no voltage of {} allows more than {:g} MHz, at {:g} V",
                    megahertz(clock), name, megahertz(chip.supply.highest.clock),
                    chip.supply.highest.voltage.count()));
  setting.overrides.push_back(fmt::format("supply.voltage={:.6g}V", setting.voltage->count()));
  return setting;
}

std::vector<Hertz> default_clocks(const sim::ChipConfig& chip) {
  constexpr std::int64_t kClocks = 8, kStep = 10'000'000;
  const Hertz highest = sim::knows_energy(chip)
                            ? chip.supply.highest.clock
                            : std::max(chip.cluster.clock, chip.controller.clock);
  std::vector<Hertz> clocks;
  for (std::int64_t k = 1; k < kClocks; ++k) {
    const Hertz clock((highest.count() * k / kClocks + kStep / 2) / kStep * kStep);
    if (clock > (clocks.empty() ? Hertz(0) : clocks.back()) && clock < highest)
      clocks.push_back(clock);
  }
  clocks.push_back(highest);
  return clocks;
}

void add_tune_options(CLI::App& command, TuneOptions& options) {
  const TextOptions add{command};
  add_chip_run_options(command, options);
  command.get_option("--seed")->type_name("N,...")->description(fmt::format(
      "of the workload's random draws; figures are medians over them [{}]", kTunedSeeds));
  add("--size", options.size, "WxH", "image size [160x120]");
  add("--clock", options.clocks, "LOW:HIGH:STEP",
      "clocks in MHz; also a list 120,240,370 [eight up to the chip's highest]");
  add("--fps", options.fps, "F,...", "frames per second of the camera [the recorded rate]");
  add("--deadline", options.busy, "drop|queue",
      "what becomes of a frame that finds the front end busy [drop]");
  add("--miss-rate", options.miss_rate, "SHARE", "of frames that may be dropped or late [0.05]");
  add("--ate", options.ate, "M", "absolute trajectory error that is accepted, in metres [0.2]");
  command.add_flag(
      "--perturb", options.perturbs,
      "in place of seeds: starts over the recording, clocks 2 % off, a small gyro bias [where the "
      "profile draws nothing at random and no seeds are given]");
  add_gate_options(command, options.gate);
}

TunePlan make_tune_plan(const TuneOptions& options, ProgressLine::Style progress) {
  TunePlan plan;
  refuse_operating_points(options);
  plan.options = options;
  choose_variations(options, plan);
  const sim::ChipConfig& chip = plan.request.platform.config;
  const std::vector<Hertz> clocks =
      options.clocks.empty() ? default_clocks(chip) : parse_clocks(options.clocks);
  // The fastest first: it is what cannot be had.
  for (auto clock = clocks.rbegin(); clock != clocks.rend(); ++clock)
    plan.clocks.push_back(setting_for(chip, plan.request.platform.name, *clock));
  std::reverse(plan.clocks.begin(), plan.clocks.end());
  plan.deadline = soc::parse_deadline(options.busy);
  plan.miss_rate = parse_miss_rate(options.miss_rate);
  plan.ate_m = parse_positive("--ate", options.ate);
  if (!options.fps.empty()) plan.fps = parse_rates(options.fps);
  plan.request.data = data_folder(options, progress);
  plan.request.pictures = std::make_shared<traces::PictureMemory>();
  plan.recorded_hz = checked_recorded_rate(plan.request, plan.fps);
  if (plan.fps.empty()) plan.fps = {plan.recorded_hz};
  plan.sequence = open_sequence({options.data, plan.request.data}, plan.request.frames,
                                {plan.request.image_size});
  if (plan.perturbs) add_perturbations(plan);
  return plan;
}

}  // namespace leviosim::tools
