// The options of `leviosim tune`: as typed, and what they ask for once checked.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/budget/gate.h"
#include "tools/app/cli/progress_line.h"
#include "tools/app/run/run_options.h"
#include "tools/app/run/run_request.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/sequence.h"
#include "tools/app/study/study.h"

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

/// As typed. RunOptions::seed is a list here; empty: kTunedSeeds, or perturbations.
struct TuneOptions : StudyOptions {
  TuneOptions() { seed.clear(); }

  std::string clocks;  ///< empty: default_clocks()
  std::string fps;
  std::string busy = "drop";  ///< --deadline
  std::string miss_rate = "0.05";
  std::string ate = "0.2";
  bool perturbs = false;
  GateOptions gate;
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
  std::vector<Variation> variations;  ///< of a point that is recommended …
  std::size_t screening = 0;  ///< … and how many of them, from the first on, of every point
  bool perturbs = false;      ///< they are perturbations; else seeds
  Deadline deadline = Deadline::Drop;
  double miss_rate = 0;  ///< share of missed frames that is allowed
  double ate_m = 0;      ///< error that is allowed
  Measure measure;
};

void add_tune_options(CLI::App& command, TuneOptions& options);

/// @param progress  of the synthetic flight, if it has to be made
/// @throws InputError naming the option
TunePlan make_tune_plan(const TuneOptions& options, ProgressLine::Style progress);

/// Eight clocks up to the highest that the supply allows, or that the chip has, evenly apart, each
/// but the highest in whole tens of MHz.
std::vector<Hertz> default_clocks(const sim::ChipConfig& chip);

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

}  // namespace leviosim::tools
