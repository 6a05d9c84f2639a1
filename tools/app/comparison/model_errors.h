// Errors of the model against cycles measured on a chip, stage by stage.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/comparison/comparison.h"

namespace leviosim::tools {

/// Cycles of a call, or of a frame, in the model and as measured.
struct ModelError {
  std::string stage;
  std::optional<double> measured;
  std::optional<double> model;
  std::optional<double> percent;  ///< error in per cent of the measured value
};

/// Of each stage, and last of the frame, where one of the runs was measured (A, if both were).
std::vector<ModelError> model_errors(const RunComparison& comparison);

/// A table of them, and their mean.
std::string measured_report(const RunComparison& comparison, bool markdown);

}  // namespace leviosim::tools
