#include "tools/app/study/sensitivity/sensitivity.h"

#include <algorithm>
#include <cmath>

#include "sim/chip/accelerator.h"
#include "sim/soc/job_timer.h"
#include "tools/app/result/summary.h"
#include "tools/app/run/range_bands.h"
#include "traces/work_traces/work_frames.h"

namespace leviosim::tools {
namespace {

bool is_uncertain(const platform::Parameter& parameter) {
  return parameter.confidence != "high" && !parameter.unit.empty() && is_of_time(parameter);
}

class Average {
 public:
  void add(double value) {
    sum_ += value;
    ++n_;
  }
  double mean() const { return sum_ / static_cast<double>(n_); }
  std::optional<double> ms(Hertz clock) const {
    if (n_ == 0) return std::nullopt;
    return mean() * 1e3 / static_cast<double>(clock.count());
  }

 private:
  double sum_ = 0;
  std::int64_t n_ = 0;
};

/// Calls of stages, by name.
class StageAverages {
 public:
  void add(const sim::JobTiming& timing) {
    for (const sim::StageTiming& stage : timing.stages) {
      const auto found = std::find_if(stages_.begin(), stages_.end(),
                                      [&](const auto& s) { return s.first == stage.stage; });
      Average& average = found != stages_.end()
                             ? found->second
                             : stages_.emplace_back(std::string(stage.stage), Average{}).second;
      average.add(static_cast<double>(stage.cycles.count()) * 1e-3);
    }
  }
  std::vector<std::pair<std::string, double>> kcycles() const {
    std::vector<std::pair<std::string, double>> result;
    for (const auto& [name, average] : stages_) result.emplace_back(name, average.mean());
    return result;
  }

 private:
  std::vector<std::pair<std::string, Average>> stages_;
};

double largest(std::optional<double> a, std::optional<double> b) {
  return std::max(std::abs(a.value_or(0)), std::abs(b.value_or(0)));
}

}  // namespace

MeanTimes time_on(const sim::ChipConfig& chip, int workers, const traces::WorkTrace& trace) {
  soc::JobTimer timer(chip, workers);
  Average frame;
  Average epnp;
  Average eight_point;
  Average iteration;
  StageAverages stages;
  traces::WorkFrames reader(trace, sim::has_accelerators(chip), sim::code_of(chip));
  for (traces::WorkFrame recorded; reader.next(recorded);) {
    for (const work::Job& job : recorded.iterations) {
      Cycles cycles;
      const sim::JobTiming timing = timer.optimiser(job);
      for (const sim::StageTiming& stage : timing.stages) cycles += stage.cycles;
      stages.add(timing);
      iteration.add(static_cast<double>(cycles.count()));
    }
    if (recorded.source == name_of(PoseSource::First)) continue;  // which only starts a map
    const sim::JobTiming timing = timer.front_end(recorded.front_end);
    const auto cycles = static_cast<double>(timer.front_end_cycles(timing).count());
    stages.add(timing);
    frame.add(cycles);
    if (recorded.source == name_of(PoseSource::Epnp)) epnp.add(cycles);
    if (recorded.source == name_of(PoseSource::EightPoint)) eight_point.add(cycles);
  }
  const Hertz clock = chip.cluster.clock;
  return {frame.ms(clock), epnp.ms(clock), eight_point.ms(clock),
          iteration.ms(chip.controller.clock), stages.kcycles()};
}

std::optional<double> MeanTimes::stage(std::string_view name) const {
  for (const auto& [stage, kcycles] : stages)
    if (stage == name) return kcycles;
  return std::nullopt;
}

std::vector<StageBand> stage_bands(const Sensitivity& sensitivity) {
  std::vector<StageBand> bands;
  for (const auto& [stage, kcycles] : sensitivity.base.stages) {
    BandOf band(kcycles);
    for (const Swing& swing : sensitivity.swings)
      if (swing.is_in_bands)
        band.add(swing.low.stage(stage).value_or(kcycles),
                 swing.high.stage(stage).value_or(kcycles));
    bands.push_back({stage, band.band()});
  }
  return bands;
}

std::optional<double> percent_change(std::optional<double> value, std::optional<double> base) {
  if (!value || !base || *base == 0) return std::nullopt;
  return 100 * (*value / *base - 1);
}

double effect_on_frame(const Swing& swing, const MeanTimes& base) {
  return largest(percent_change(swing.low.frame, base.frame),
                 percent_change(swing.high.frame, base.frame));
}

double effect_on_iteration(const Swing& swing, const MeanTimes& base) {
  return largest(percent_change(swing.low.iteration, base.iteration),
                 percent_change(swing.high.iteration, base.iteration));
}

Sensitivity sensitivity(const platform::Variants& platform, int workers,
                        const traces::WorkTrace& trace, const RunnerOptions& options) {
  Sensitivity result;
  const auto times = [&](const sim::ChipConfig& chip) { return time_on(chip, workers, trace); };
  result.base = times(platform.config({}));
  const auto run = [&](std::size_t count, const auto& job) { run_all(count, options, job); };
  const auto alone = [](const platform::Change& change) { return std::vector{change}; };
  for (auto& ends :
       at_ends(platform, ranged(platform.platform()), result.base, times, run, alone))
    result.swings.push_back({*ends.parameter, std::move(ends.low), std::move(ends.high),
                             is_in_bands(*ends.parameter, platform.platform().config)});
  std::stable_sort(result.swings.begin(), result.swings.end(), [&](const Swing& a, const Swing& b) {
    const double frame_a = effect_on_frame(a, result.base);
    const double frame_b = effect_on_frame(b, result.base);
    if (frame_a != frame_b) return frame_a > frame_b;
    return effect_on_iteration(a, result.base) > effect_on_iteration(b, result.base);
  });
  for (const platform::Parameter& parameter : platform.platform().parameters)
    if (!parameter.range && is_uncertain(parameter)) result.unbounded.push_back(parameter.path);
  return result;
}

}  // namespace leviosim::tools
