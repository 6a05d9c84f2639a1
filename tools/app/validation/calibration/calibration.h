// Fits a few global constants of a platform to measured single-core cycles of stages: least squares
// of the logarithms of simulated over measured, every stage with the same weight, each constant
// within the range that the platform file gives.
//
// Means of a call are compared as they are. The paper prints no inputs, so its values cannot be
// normalised; dividing only the simulated ones by theirs would change nothing. What a difference of
// the inputs does to the fit shows in the leave-one-out table: a stage whose input differs is off
// from what the others predict.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "platform_models/loader/variants.h"
#include "sim/chip/config.h"
#include "sim/chip/cost.h"
#include "tools/app/report/statistic_list.h"
#include "tools/app/validation/frame_log.h"

namespace leviosim::tools {

// Least squares between bounds, for a handful of unknowns and smooth residuals: Levenberg–Marquardt
// on the unknowns that are free, with derivatives from finite differences. An unknown at a bound
// that the cost pushes outwards is held there. Started from several points of the box, since what
// is fitted need not be convex. Deterministic.

struct Box {
  std::vector<double> low;
  std::vector<double> high;
};

struct Fit {
  std::vector<double> at;
  double cost = 0;  ///< sum of the squared residuals
};

using Residuals = std::function<std::vector<double>(const std::vector<double>&)>;

/// @param start  inside the box; the first of the points from which it is started
Fit least_squares(const Residuals& residuals, const Box& box, const std::vector<double>& start);

// What a stage would take on one core of a chip whose code-generation constants were others, from
// one recorded run: its operations are costed again, without running anything.
//
// On one core nothing contends, so its time is the sum of what its operations cost alone
// (sim/chip/cost.h), and of code fetches, forks, barriers, transfers and rounding, which do not
// depend on these constants. The latter is what the recorded time exceeds the cost of the
// operations on the chip of the run by.

struct StageModel {
  std::string key;
  std::string title;
  std::int64_t frames = 0;
  sim::WorkSum work;     ///< of the frames
  double fixed = 0;      ///< cycles beside the operations, summed over the frames
  double reference = 0;  ///< cycles of a mean call that the fit aims at

  /// Cycles of a mean call on one core.
  double cycles(const sim::ChipConfig& chip) const;
};

/// The six stages of the paper's table from a run on `chip`; aims are the paper's one-core values.
/// @throws InputError if the run has no frame of a stage
std::vector<StageModel> stage_models(const FrameLog& log, const sim::ChipConfig& chip);

// The constants that a calibration may fit: what a compiler adds to the operations of a source
// program, for all code of the instruction set alike. None belongs to a kernel or a stage, and
// nothing that a data sheet, RTL or a measurement gives is among them.

struct FittableConstant {
  std::string_view path;
  std::string_view mechanism;
};

inline constexpr std::array kFittableConstants{
    FittableConstant{"isa.instruction_overhead", "the vendor's compiler"},
    FittableConstant{"isa.load_use_fraction", "loads in code that was not measured"},
    FittableConstant{"isa.ops.loop_iteration.issue",
                     "counter and branch of loops that are no hardware loops"},
    FittableConstant{"isa.ops.loop_entry.issue", "pointers and counter set up before a loop"},
    FittableConstant{"isa.ops.call.issue", "registers saved and restored around a call"},
    FittableConstant{"isa.ops.load_indexed.issue", "address arithmetic of a load"},
    FittableConstant{"isa.ops.store_indexed.issue", "address arithmetic of a store"},
};

inline constexpr std::size_t kMostConstants = 3;
inline constexpr const char* kDefaultConstants =
    "isa.instruction_overhead,isa.load_use_fraction,isa.ops.loop_iteration.issue";

/// "a,b,c" → paths.
/// @throws InputError for none, more than three, one twice, and what must not be fitted
std::vector<std::string> parse_constants(const std::string& option, const std::string& text);

/// A constant as a number between bounds, in its unit.
struct Bounded {
  std::string path;
  std::string unit;
  double value = 0;
  double low = 0;
  double high = 0;
};

/// @throws InputError if the platform gives no range to fit within
std::vector<Bounded> bounds_of(const platform::Variants& platform,
                               const std::vector<std::string>& paths);

/// A stage before and after.
struct Residual {
  std::string stage;
  double reference = 0;  ///< cycles
  double before = 0;     ///< simulated cycles with the platform as it was
  double after = 0;      ///< with the fitted constants
};

/// What the others say of a stage.
struct LeftOut {
  std::string stage;
  double reference = 0;           ///< cycles
  double predicted = 0;           ///< cycles with the constants fitted to all other stages
  std::vector<double> constants;  ///< these constants
};

struct Calibration {
  std::vector<Bounded> constants;  ///< as they were
  std::vector<double> fitted;
  std::vector<Residual> residuals;
  std::vector<LeftOut> left_out;
};

/// Of a simulated over a measured value, in per cent.
double percent_error(double simulated, double reference);
/// Mean of the absolute errors in per cent.
double mean_error_before(const Calibration& calibration);
double mean_error_after(const Calibration& calibration);
double mean_error_left_out(const Calibration& calibration);

Calibration calibrate(const platform::Variants& platform, const std::vector<StageModel>& stages,
                      const std::vector<std::string>& constants);

/// The platform with the fitted constants and their new source.
platform::ResolvedPlatform calibrated_platform(const platform::Variants& platform,
                                               const Calibration& calibration);

// The text that `leviosim calibrate` prints.

std::string constants_table(const Calibration& calibration);
std::string residual_table(const Calibration& calibration);
std::string left_out_table(const Calibration& calibration);
/// All of them, as parts of a screen.
std::vector<std::string> calibration_report(const Calibration& calibration);
/// What the fit is worth, in a sentence.
std::string calibration_conclusion(const Calibration& calibration);

/// Constants, residuals and stages left out, in the units of Calibration.
Json calibration_json(const Calibration& calibration);

}  // namespace leviosim::tools
