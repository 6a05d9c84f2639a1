// The paper's parameter sweep: points of the parameters (dimensions.h), each run with every profile
// over every sequence, condensed to a result per point and profile.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/study/batch_plan.h"
#include "tools/app/study/explore/dimensions.h"
#include "tools/app/study/spread.h"

namespace leviosim::tools {

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

/// Points of parameters.
using ExplorationPoints = std::vector<std::vector<vio::Assignment>>;

/// Rows are by point, profile, then sequence_names().
std::vector<Point> exploration_runs(const BatchPlan& plan, const ExplorationPoints& points);
/// The point of a row.
std::size_t point_of_row(const BatchPlan& plan, std::size_t row);

/// By point, then profile. @param runs  exploration_runs()
std::vector<ExploredPoint> explored_points(const BatchPlan& plan, const ExplorationPoints& points,
                                           const std::vector<Point>& runs,
                                           const std::vector<RunOutcome>& outcomes);

/// The best of a profile by a mean; nullptr if all diverged. The earlier one of equals.
const ExploredPoint* best_of(const std::vector<ExploredPoint>& explored, const std::string& profile,
                             std::optional<double> ExploredPoint::*by);

}  // namespace leviosim::tools
