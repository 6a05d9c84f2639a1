#include "tools/app/study/sensitivity/sensitivity.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/base/csv.h"
#include "sim/chip/accelerator.h"
#include "sim/soc/job_timer.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/result/summary.h"
#include "tools/app/run/range_bands.h"
#include "tools/app/run/recording_source.h"
#include "tools/app/run/run_session.h"
#include "tools/app/study/sensitivity/sensitivity_report.h"
#include "tools/app/study/study.h"
#include "tools/app/table/terminal_table.h"
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

double effect_on_iteration(const Swing& swing, const MeanTimes& base) {
  return largest(percent_change(swing.low.iteration, base.iteration),
                 percent_change(swing.high.iteration, base.iteration));
}

constexpr double kShown = 0.005;  ///< per cent; below, 0.00 would be printed
constexpr int kLineWidth = 100;

struct TimeColumn {
  const char* title;
  const char* key;
  std::optional<double> MeanTimes::*of;
};
constexpr std::array kTimeColumns{
    TimeColumn{"frame", "frame", &MeanTimes::frame},
    TimeColumn{"EPnP", "epnp", &MeanTimes::epnp},
    TimeColumn{"8-point", "eight_point", &MeanTimes::eight_point},
    TimeColumn{"optimiser", "iteration", &MeanTimes::iteration},
};

std::string ms(std::optional<double> value) {
  return value ? fmt::format("{:.3f} ms", *value) : "–";
}

/// "-1.2 … +3.4", what the ends of the range do.
std::string change_text(const Swing& swing, const MeanTimes& base,
                        std::optional<double> MeanTimes::*of) {
  const auto low = percent_change(swing.low.*of, base.*of);
  const auto high = percent_change(swing.high.*of, base.*of);
  if (!low || !high) return "–";
  return fmt::format("{:+.2f} … {:+.2f}", *low, *high);
}

std::string list_line(const std::string& title, const std::vector<std::string>& names) {
  if (names.empty()) return {};
  return title + "\n  " + wrap(names, ", ", 2, kLineWidth) + '\n';
}

std::string bands_table(const Sensitivity& sensitivity) {
  Table table({{"stage", kLeft}, {"kcycles"}, {"band"}, {"per cent"}});
  for (const auto& [stage, band] : stage_bands(sensitivity))
    table.add({stage, fmt::format("{:.1f}", band.value),
               fmt::format("{:.1f} … {:.1f}", band.low, band.high),
               fmt::format("{:+.1f} … {:+.1f}", percent_change(band.low, band.value).value_or(0),
                           percent_change(band.high, band.value).value_or(0))});
  return "\na mean call of each stage if all these numbers are uncertain at once (root of the sum "
         "of\n"
         "squares; of what compilers make of operations, the factors of all together)\n" +
         terminal_text(table);
}

/// The number with the largest effect, in a sentence.
std::string sensitivity_conclusion(const Sensitivity& sensitivity) {
  if (sensitivity.swings.empty()) return "in short: no number of this chip has a range";
  const Swing& swing = sensitivity.swings.front();
  return fmt::format(
      "in short: {} has the largest effect: {} % of the front end between {:g} and {:g} {}",
      swing.parameter.path, change_text(swing, sensitivity.base, &MeanTimes::frame),
      swing.parameter.range->low, swing.parameter.range->high, swing.parameter.unit);
}

// `leviosim sensitivity`: which uncertain numbers of a platform matter.

constexpr const char* kFramesByDefault = "0:100";

void declare(CLI::App& command, StudyOptions& options) {
  options.frames = kFramesByDefault;
  add_chip_run_options(command, options);
}

Answer answer(const StudyOptions& options, const RunnerOptions& runner, const Arguments&) {
  RunRequest request = make_chip_request(options);
  request.data = data_folder(options, runner.progress);
  WorkRecording recording(request.cores);
  request.recording = &recording;
  const RunResult result = simulate_with_progress(request, runner.progress);
  const traces::WorkTrace trace("recorded run", recording.writer.finish(recording.info));
  const Sensitivity found =
      sensitivity(platform::Variants(std::move(request.platform)), request.cores, trace, runner);
  Answer answer{.parts = sensitivity_tables(found, result.cores),
                .conclusion = sensitivity_conclusion(found),
                .next = {"leviosim microbench"},
                .rows = sensitivity_rows(found)};
  answer.parts.front().insert(0, heading(options, result));
  answer.page.title =
      fmt::format("Which uncertain numbers matter: {} on {}", options.profile, options.platform);
  answer.page.bars = {"number",
                      {"frame_low_percent", "frame_high_percent"},
                      "A mean frame with each number at both ends of its range"};
  answer.page.x = "frame_low_percent";
  answer.page.y = "frame_high_percent";
  answer.page.colour = "confidence";
  return answer;
}

const Study kStudy{"sensitivity",
                   "Sweep every uncertain number of a chip over its range, one at a time",
                   "chip",
                   {"leviosim sensitivity --data flight --frames 0:20 --csv sensitivity.csv"}};

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

Sensitivity sensitivity(const platform::Variants& platform, int workers,
                        const traces::WorkTrace& trace, const RunnerOptions& options) {
  Sensitivity result;
  const auto times = [&](const sim::ChipConfig& chip) { return time_on(chip, workers, trace); };
  result.base = times(platform.config({}));
  const auto run = [&](std::size_t count, const auto& job) { run_all(count, options, job); };
  for (auto& ends :
       at_ends(platform, uncertain_numbers(platform.platform()), result.base, times, run))
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

std::vector<std::string> sensitivity_tables(const Sensitivity& sensitivity, int workers) {
  std::vector<Head> columns{
      {"number", kLeft}, {"confidence", kLeft, 2}, {"value"}, {"range", kLeft, 1}};
  for (const TimeColumn& column : kTimeColumns) columns.push_back({column.title});
  Table table(std::move(columns));
  std::vector<std::string> without_effect;
  for (const Swing& swing : sensitivity.swings) {
    const platform::Parameter& p = swing.parameter;
    if (effect_on_frame(swing, sensitivity.base) < kShown &&
        effect_on_iteration(swing, sensitivity.base) < kShown) {
      without_effect.push_back(p.path);
      continue;
    }
    std::vector<Cell> cells{p.path, p.confidence, fmt::format("{} {}", p.value, p.unit),
                            fmt::format("{:g} … {:g}", p.range->low, p.range->high)};
    for (const TimeColumn& column : kTimeColumns)
      cells.push_back(change_text(swing, sensitivity.base, column.of));
    table.add(std::move(cells));
  }
  const MeanTimes& base = sensitivity.base;
  return {fmt::format(
              "mean times with all numbers as they are: front end {} on {} cores (EPnP {}, 8-point "
              "{}), optimiser {} for an iteration\n"
              "change of them in per cent at the low and at the high end of a number's range\n{}",
              ms(base.frame), workers, ms(base.epnp), ms(base.eight_point), ms(base.iteration),
              terminal_text(table)),
          bands_table(sensitivity),
          list_line("changing nothing by 0.005 % or more:", without_effect) +
              list_line("not certain, but without a range:", sensitivity.unbounded)};
}

Table sensitivity_rows(const Sensitivity& sensitivity) {
  using S = const Swing&;
  Columns<Swing> columns{{{.title = "number", .key = "number", .is_setup = true},
                          [](S s) { return s.parameter.path; }},
                         {{.title = "confidence", .key = "confidence", .is_setup = true},
                          [](S s) { return s.parameter.confidence; }},
                         {{.key = "unit"}, [](S s) { return s.parameter.unit; }},
                         {{.key = "value"}, [](S s) { return spelled(s.parameter.value); }},
                         {{.key = "low"}, [](S s) { return s.parameter.range->low; }},
                         {{.key = "high"}, [](S s) { return s.parameter.range->high; }}};
  const auto add = [&](const std::string& key, auto value, std::string title = {}) {
    columns.push_back({{.title = std::move(title), .key = key, .decimals = 6, .unit = "%"},
                       [=](S s) { return Cell(value(s)); }});
  };
  for (const TimeColumn& column : kTimeColumns) {
    const auto of = column.of;
    const std::optional<double> base_ms = sensitivity.base.*of;
    const std::string key = column.key;
    add(key + "_base_ms", [=](S) { return base_ms; });
    add(key + "_low_ms", [=](S s) { return s.low.*of; });
    add(key + "_high_ms", [=](S s) { return s.high.*of; });
    const std::string of_what = column.title;
    add(
        key + "_low_percent", [=](S s) { return percent_change(s.low.*of, base_ms); },
        of_what + " at the low end");
    add(
        key + "_high_percent", [=](S s) { return percent_change(s.high.*of, base_ms); },
        of_what + " at the high end");
  }
  for (const auto& [stage, kcycles] : sensitivity.base.stages)
    for (const auto& [name, end] :
         {std::pair{"_low_percent", &Swing::low}, {"_high_percent", &Swing::high}})
      add(key_of(stage) + name, [stage = stage, kcycles = kcycles, end = end](S s) {
        return percent_change((s.*end).stage(stage), kcycles);
      });
  return table_of(columns, sensitivity.swings);
}

Command add_sensitivity_command(CLI::App& app, const Arguments& words) {
  return add_study<StudyOptions>(
      app, words, kStudy, declare,
      [](const StudyOptions& options) { return data_inputs(options.data); }, answer);
}

}  // namespace leviosim::tools
