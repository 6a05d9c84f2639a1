// The options of `leviosim tune`: as typed, and what they ask for once checked.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/outputs/output_folder.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/html_report/page.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/run/run_request.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/engine.h"
#include "tools/app/table/table_files.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// What a draw of the workload's random numbers does to an error is seen only over several.
inline constexpr const char* kTunedSeeds = "1,2,3";

/// What differs between runs of a point that ought to come to the same: the workload's random
/// draws, or, where it draws nothing, other starts and causes that a user would not notice.
struct Variation {
  std::string name;  ///< "seed 2", "clock -2 %"
  std::uint32_t seed = 1;
  std::size_t later = 0;  ///< frames that are left out at the start
  double clock = 1;       ///< factor of the point's
  double gyro_bias = 0;   ///< of all samples [rad/s]
};

/// As typed.
struct TuneWords {
  TuneWords() { run.seed = kTunedSeeds; }

  RunOptions run;  ///< with a list of seeds
  std::string clocks;
  std::string fps;
  std::string deadline = "drop";
  std::string miss_rate = "0.05";
  std::string ate = "0.2";
  bool perturbs = false;
  RunnerWords runner;
};

/// What a clock comes with.
struct ClockSetting {
  Hertz clock;
  std::optional<Volts> voltage;  ///< the lowest that allows it; none if the chip has no supply
  std::vector<std::string> overrides;  ///< that set both, besides the user's
};

struct TunePlan {
  RunOptions options;  ///< of every point; without what a point sets
  RunRequest request;  ///< the same, checked
  Sequence sequence;
  double recorded_hz = 0;
  std::vector<ClockSetting> clocks;   ///< rising
  std::vector<double> fps;            ///< rising
  std::vector<Variation> variations;  ///< of every point
  bool perturbs = false;              ///< they are perturbations; else seeds
  Deadline deadline = Deadline::Drop;
  double miss_rate = 0;  ///< share of missed frames that is allowed
  double ate_m = 0;      ///< error that is allowed
  Measure measure;
  RunnerOptions runner;
  std::shared_ptr<outputs::OutputFolder> out;  ///< if results are to be written
};

void add_tune_options(CLI::App& command, TuneWords& words);

/// @throws InputError naming the option
TunePlan make_tune_plan(const CLI::App& command, const TuneWords& words);

/// "100:370:10" or "120,240,370": clocks in MHz, both ends included, rising. @throws InputError
std::vector<Hertz> parse_clocks(const std::string& text);

/// "1,2,3", in this order. @throws InputError
std::vector<std::uint32_t> parse_seed_list(const std::string& text);

/// "10,15,20": rising. @throws InputError
std::vector<double> parse_rates(const std::string& text);

/// How the chip runs at a clock: the faster of its two clocks has it, the other one keeps its ratio
/// to that, and the supply is as low as it can be.
/// @param chip  what the user asked for
/// @throws InputError for a clock that no voltage allows
ClockSetting setting_for(const sim::ChipConfig& chip, const std::string& name, Hertz clock);

// Accuracy and power of closed loops over clock and frame rate, and the lowest clock that is
// enough.

/// A clock at a frame rate.
struct TunePoint {
  double fps = 0;
  ClockSetting setting;
  std::vector<RunOutcome> outcomes;  ///< by variation

  /// Median over the variations of a figure of their loops.
  double median(const std::function<double(const LoopOutcome&)>& of) const;
  /// The same of a figure that chips without energies lack.
  std::optional<Banded> median(std::optional<Banded> LoopOutcome::*of) const;
  /// Dropped or late frames over all, and dropped ones.
  double miss_rate() const;
  double drop_rate() const;
  /// Of the absolute errors; one above the length of the path counts as diverged.
  Spread ate() const;
  /// Runs that err more than that, or diverged.
  std::size_t failures(double ate_m) const;
  /// Least share of frames with a pose that was compared.
  double completion() const;
};

/// The closed loop of a point.
RunRequest request_of(const TunePlan& plan, double fps, const ClockSetting& setting,
                      const Variation& variation);

/// By frame rate, clock, then variation; the sequence of the plan must outlive them.
std::vector<Point> tune_runs(const TunePlan& plan);

/// @param runs  tune_runs()
std::vector<TunePoint> tune_points(const TunePlan& plan, const std::vector<Point>& runs,
                                   const std::vector<RunOutcome>& outcomes);

/// Whether it misses no more frames than the plan allows, and 95 % of its runs err no more.
bool is_enough(const TunePoint& point, const TunePlan& plan);

/// What the plan's limits come to at a frame rate.
struct Choice {
  double fps = 0;
  /// The lowest clock that is enough, as all higher ones are; none if the highest is not.
  const TunePoint* lowest = nullptr;
  /// Lower clocks that are enough, but below one that is not: no clocks to build on.
  std::vector<const TunePoint*> lucky;
  const TunePoint* highest_failing = nullptr;
};
/// By frame rate. @param points  outlive the choices
std::vector<Choice> choices(const TunePlan& plan, const std::vector<TunePoint>& points);

/// The lowest of these clocks; of equal clocks, that of the higher frame rate. nullptr if none is
/// enough.
const TunePoint* chosen(const std::vector<Choice>& choices);

/// A line for a shell that runs a point by itself: unperturbed, or with each seed into a folder of
/// its own: chosen, or chosen-1, chosen-2, … if there are several.
std::string run_command_text(const TunePlan& plan, const TunePoint& point);
/// The options of that command, with the first variation.
RunOptions run_options_of(const TunePlan& plan, const TunePoint& point);

// What `leviosim tune` found, as text, CSV and JSON.

/// A row per point.
std::string tune_table(const TunePlan& plan, const std::vector<TunePoint>& points);
Table tune_rows(const TunePlan& plan, const std::vector<TunePoint>& points);

/// The lowest clock at each frame rate.
std::string choice_text(const TunePlan& plan, const std::vector<Choice>& choices);

/// That of all, in a sentence.
std::string tune_conclusion(const std::vector<Choice>& choices);

/// `leviosim tune` (tools/commands/commands.h).
Command add_tune_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
