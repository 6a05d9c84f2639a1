// Accuracy as text. Every command that reports it does so through these, so that a figure looks the
// same everywhere and never goes without its protocol.
#pragma once

#include <string>
#include <vector>

#include "traces/trajectories/evaluation.h"
#include "traces/trajectories/trajectory_errors.h"

namespace leviosim::tools {

/// "ATE: … m RMSE (…)", the protocol in a second line, and attitude_text() in a third.
std::string ate_text(const traces::Evaluation& evaluation);

/// "attitude: tilt …° RMSE, heading …° RMSE", after an alignment of the attitudes, and whether the
/// estimate knows the vertical. Empty where the evaluation holds no poses.
std::string attitude_text(const traces::Evaluation& evaluation);

/// A row per length that has sub-trajectories, with the protocol below, and a line that names the
/// lengths that are too long for the path. Empty for no lengths.
std::string relative_text(const traces::Evaluation& evaluation,
                          const std::vector<traces::RelativeErrors>& errors);

}  // namespace leviosim::tools
