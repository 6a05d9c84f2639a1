// Fits a few global constants of a platform to measured single-core cycles of stages: least squares
// of the logarithms of simulated over measured, every stage with the same weight, each constant
// within the range that the platform file gives.
//
// Means of a call are compared as they are. The paper prints no inputs, so its values cannot be
// normalised; dividing only the simulated ones by theirs would change nothing. What a difference of
// the inputs does to the fit shows in the leave-one-out table: a stage whose input differs is off
// from what the others predict.
#pragma once

#include <string>
#include <vector>

#include "platform_models/loader/variants.h"
#include "tools/app/validation/calibration/constants.h"
#include "tools/app/validation/calibration/stage_model.h"

namespace leviosim::tools {

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

}  // namespace leviosim::tools
