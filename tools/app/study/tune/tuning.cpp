#include "tools/app/study/tune/tuning.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "sim/base/interruption.h"
#include "sim/base/printable.h"
#include "sim/energy/model.h"
#include "tools/app/run/workload_options.h"
#include "tools/app/study/tune/tune_plan.h"
#include "tools/app/table/terminal_table.h"
#include "traces/datasets/disturbance.h"

namespace leviosim::tools {
namespace {

std::vector<std::string> overrides_at(const TunePlan& plan, const ClockSetting& setting) {
  std::vector<std::string> all = plan.options.overrides;
  all.insert(all.end(), setting.overrides.begin(), setting.overrides.end());
  return all;
}

Point run_of(const TunePlan& plan, double fps, const ClockSetting& setting,
             const Variation& variation, std::size_t row) {
  std::string work = plan.sequence.work;
  if (plan.perturbs) work += fmt::format("\nperturbed: {}", variation.name);
  return {.request = request_of(plan, fps, setting, variation),
          .work = std::move(work),
          .sequence = &plan.sequence,
          .row = row};
}

}  // namespace

double TunePoint::median(const std::function<double(const LoopOutcome&)>& of) const {
  return *spread_of(values_of(outcomes, [&](const RunOutcome& o) { return of(*o.loop); })).median;
}

std::optional<Banded> TunePoint::median(std::optional<Banded> LoopOutcome::*of) const {
  const auto part = [&](double Banded::*end) {
    return spread_of(values_of(outcomes,
                               [=](const RunOutcome& outcome) {
                                 const std::optional<Banded>& figure = *outcome.loop.*of;
                                 return figure ? std::optional(*figure.*end) : std::nullopt;
                               }))
        .median;
  };
  const auto value = part(&Banded::value);
  if (!value) return std::nullopt;
  return Banded{*value, part(&Banded::low).value_or(0), part(&Banded::high).value_or(0)};
}

double TunePoint::miss_rate() const {
  return median([](const LoopOutcome& l) { return l.camera.share_of(l.camera.missed()); });
}

double TunePoint::drop_rate() const {
  return median([](const LoopOutcome& l) { return l.camera.share_of(l.camera.dropped); });
}

Spread TunePoint::ate() const { return spread_of(values_of(outcomes, error_of)); }

double TunePoint::completion() const {
  double least = 1;
  for (const RunOutcome& outcome : outcomes) least = std::min(least, outcome.completion);
  return least;
}

RunRequest request_of(const TunePlan& plan, double fps, const ClockSetting& setting,
                      const Variation& variation) {
  RunRequest request = plan.request;
  request.seed = variation.seed;
  request.camera = CameraRequest{fps, plan.deadline};
  ClockSetting perturbed = setting;
  if (variation.clock != 1) {
    const sim::ChipConfig& chip = plan.request.platform.config;
    Hertz clock(std::llround(static_cast<double>(setting.clock.count()) * variation.clock));
    if (sim::knows_energy(chip)) clock = std::min(clock, chip.supply.highest.clock);
    perturbed = setting_for(chip, plan.request.platform.name, clock);
  }
  if (variation.later > 0) {
    const std::size_t begin = request.frames ? request.frames->begin : 0;
    request.frames = traces::FrameRange{begin + variation.later, begin + plan.sequence.frames};
  }
  if (variation.gyro_bias != 0)
    request.disturbance =
        traces::parse_disturbance(fmt::format("gyro-bias={}", variation.gyro_bias));
  throw_if_interrupted();
  request.overrides = split_overrides(overrides_at(plan, perturbed)).chip;
  request.platform = platform::resolve_platform(plan.options.platform, request.overrides);
  return request;
}

std::vector<Point> tune_runs(const TunePlan& plan) {
  std::vector<Point> runs;
  std::size_t row = 0;
  for (const double fps : plan.fps)
    for (const ClockSetting& setting : plan.clocks) {
      for (std::size_t i = 0; i < plan.screening; ++i)
        runs.push_back(run_of(plan, fps, setting, plan.variations[i], row));
      ++row;
    }
  return runs;
}

void confirm(const TunePlan& plan, std::vector<TunePoint>& points, const RunTunePoints& run) {
  const auto unconfirmed = [&]() -> TunePoint* {
    for (const Choice& choice : choices(plan, points))
      if (choice.lowest != nullptr && choice.lowest->outcomes.size() < plan.variations.size())
        return &points[static_cast<std::size_t>(choice.lowest - points.data())];
    return nullptr;
  };
  while (TunePoint* const point = unconfirmed()) {
    std::vector<Point> runs;
    for (std::size_t i = point->outcomes.size(); i < plan.variations.size(); ++i)
      runs.push_back(run_of(plan, point->fps, point->setting, plan.variations[i], 0));
    const std::vector<RunOutcome> more = run(runs);
    point->outcomes.insert(point->outcomes.end(), more.begin(), more.end());
  }
}

double share_held(std::size_t runs, std::size_t failures) {
  const auto seen_by_chance = [&](double fails) {  // so few failures, or fewer
    double probability = std::pow(1 - fails, static_cast<double>(runs)), sum = probability;
    for (std::size_t k = 1; k <= failures; ++k) {
      probability *=
          static_cast<double>(runs - k + 1) / static_cast<double>(k) * fails / (1 - fails);
      sum += probability;
    }
    return sum;
  };
  if (failures >= runs) return 0;
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (seen_by_chance(middle) > 0.05 ? low : high) = middle;
  }
  return 1 - low;
}

std::vector<TunePoint> tune_points(const TunePlan& plan, const std::vector<Point>& runs,
                                   const std::vector<RunOutcome>& outcomes) {
  auto row = by_row(runs, outcomes, plan.fps.size() * plan.clocks.size());
  std::vector<TunePoint> points;
  for (const double fps : plan.fps)
    for (const ClockSetting& setting : plan.clocks)
      points.push_back({fps, setting, std::move(row[points.size()])});
  return points;
}

std::size_t TunePoint::failures(double ate_m) const {
  return static_cast<std::size_t>(
      std::count_if(outcomes.begin(), outcomes.end(), [&](const RunOutcome& outcome) {
        const std::optional<double> error = error_of(outcome);
        return !error || *error > ate_m;
      }));
}

bool is_enough(const TunePoint& point, const TunePlan& plan) {
  constexpr std::size_t kOneFailsOf = 20;
  return point.miss_rate() <= plan.miss_rate &&
         point.failures(plan.ate_m) * kOneFailsOf <= point.outcomes.size();
}

std::vector<Choice> choices(const TunePlan& plan, const std::vector<TunePoint>& points) {
  std::vector<Choice> all;
  for (const double fps : plan.fps) {
    Choice choice{fps, nullptr, {}, nullptr};
    for (auto point = points.rbegin(); point != points.rend(); ++point) {  // clocks fall
      if (point->fps != fps) continue;
      if (!is_enough(*point, plan)) {
        if (choice.highest_failing == nullptr) choice.highest_failing = &*point;
      } else if (choice.highest_failing == nullptr) {
        choice.lowest = &*point;
      } else {
        choice.lucky.push_back(&*point);
      }
    }
    all.push_back(std::move(choice));
  }
  return all;
}

const TunePoint* chosen(const std::vector<Choice>& choices) {
  const TunePoint* best = nullptr;
  for (const Choice& choice : choices)
    if (choice.lowest != nullptr &&
        (best == nullptr || choice.lowest->setting.clock <= best->setting.clock))
      best = choice.lowest;
  return best;
}

RunOptions run_options_of(const TunePlan& plan, const TunePoint& point) {
  RunOptions options = plan.options;
  options.overrides = overrides_at(plan, point.setting);
  options.camera_fps = fmt::format("{}", point.fps);
  options.deadline = info_of(plan.deadline).name;
  return options;
}

std::string run_command_text(const TunePlan& plan, const TunePoint& point) {
  const RunOptions options = run_options_of(plan, point);
  const RunOptions defaults;
  std::vector<std::string> words{"leviosim", "run", "--platform", shell_word(options.platform)};
  const auto add = [&](const char* name, const std::string& value, const std::string& by_default) {
    if (value == by_default) return;
    words.emplace_back(name);
    words.push_back(shell_word(value));
  };
  for (const std::string& text : options.overrides) add("-p", text, "");
  add("--data", options.data, "");
  add("--profile", options.profile, defaults.profile);
  add("--frames", options.frames, "");
  add("--cores", options.cores, "");
  add("--size", options.size, defaults.size);
  add("--fps", options.camera_fps, "");
  add("--deadline", options.deadline, "");
  if (plan.perturbs || plan.variations.size() == 1) {
    add("--seed", options.seed, defaults.seed);
    return fmt::format("{} --out chosen", fmt::join(words, " "));
  }
  std::vector<std::uint32_t> seeds;
  for (const Variation& variation : plan.variations) seeds.push_back(variation.seed);
  return fmt::format("for seed in {}; do {} --seed $seed --out chosen-$seed; done",
                     fmt::join(seeds, " "), fmt::join(words, " "));
}

}  // namespace leviosim::tools
