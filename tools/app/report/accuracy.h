// Accuracy as text and as statistics. Every command that reports it does so through these, so that
// a figure looks the same everywhere and never goes without its protocol.
#pragma once

#include <string>
#include <vector>

#include "tools/app/report/statistic_list.h"
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

/// "accuracy.ate.rmse" and so on.
/// @param attitude  where it is known, tilt and heading; runs leave it out, since replays do not
///                  know it
void add_ate(StatisticList& list, const traces::Evaluation& evaluation,
             const std::optional<traces::AttitudeErrors>& attitude = {});

/// "accuracy.relative.40m.translation.mean" and so on; null where a length has no sub-trajectory.
void add_relative(StatisticList& list, const traces::Evaluation& evaluation,
                  const traces::RelativeErrors& errors);

}  // namespace leviosim::tools
