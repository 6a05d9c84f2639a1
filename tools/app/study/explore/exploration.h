// The paper's parameter sweep: points of the parameters (dimensions.h), each run with every profile
// over every sequence, condensed to a result per point and profile.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/study/batch/batch_options.h"
#include "tools/app/study/batch/spread.h"
#include "tools/app/study/explore/dimensions.h"

namespace leviosim::tools {

struct ExplorationRuns {
  std::vector<BatchRun> runs;
  std::vector<std::size_t> point;  ///< of each run
};

/// A point with one profile.
struct ExploredPoint {
  std::size_t point = 0;
  std::string profile;
  std::vector<vio::Assignment> set;  ///< what has an effect on the profile
  struct OfSequence {
    std::string sequence;
    Spread ate;       ///< [m], over seeds and folders
    Spread relative;  ///< [%]
  };
  std::vector<OfSequence> sequences;
  /// Means over the sequences of their medians; none if one of them diverged.
  std::optional<double> mean_ate;
  std::optional<double> mean_relative;
};

/// What of a point has an effect on a profile: without IMU, the noise of the IMU has none.
std::vector<vio::Assignment> effective(const std::vector<vio::Assignment>& point,
                                       const std::string& profile);

ExplorationRuns exploration_runs(const BatchPlan& plan,
                                 const std::vector<std::vector<vio::Assignment>>& points);

/// By point, then profile.
std::vector<ExploredPoint> explored_points(const BatchPlan& plan,
                                           const std::vector<std::vector<vio::Assignment>>& points,
                                           const ExplorationRuns& runs,
                                           const std::vector<RunOutcome>& outcomes);

/// The best of a profile by a mean; nullptr if all diverged. The earlier one of equals.
const ExploredPoint* best_of(const std::vector<ExploredPoint>& explored, const std::string& profile,
                             std::optional<double> ExploredPoint::*by);

}  // namespace leviosim::tools
