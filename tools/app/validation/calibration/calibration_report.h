// The text that `leviosim calibrate` prints.
#pragma once

#include <string>

#include "tools/app/report/statistic_list.h"
#include "tools/app/validation/calibration/calibration.h"

namespace leviosim::tools {

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
