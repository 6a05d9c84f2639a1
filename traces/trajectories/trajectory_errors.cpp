#include "traces/trajectories/trajectory_errors.h"

#include <Eigen/SVD>

#include <algorithm>
#include <utility>
#include <vector>

#include "sim/base/check.h"

namespace leviosim::traces {
namespace {

/// The pose `to` seen from `from`.
Eigen::Isometry3d step(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  return from.inverse() * to;
}

}  // namespace

RelativeErrors relative_errors(const Evaluation& evaluation, double length_m) {
  check(length_m > 0, "relative_errors: the length is above 0");
  const std::vector<double>& distances = evaluation.distances_m;
  std::vector<double> translation;
  std::vector<double> rotation;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const auto end =
        std::partition_point(distances.begin() + static_cast<std::ptrdiff_t>(i), distances.end(),
                             [&](double d) { return d - distances[i] < length_m; });
    if (end == distances.end()) break;  // what starts later is shorter still
    const MatchedPose& first = evaluation.poses[i];
    const MatchedPose& last = evaluation.poses[static_cast<std::size_t>(end - distances.begin())];
    const Eigen::Isometry3d error =
        step(step(first.truth, last.truth), step(first.estimate, last.estimate));
    translation.push_back(error.translation().norm() / length_m * 100);
    rotation.push_back(angle_deg(error.linear()) / length_m);
  }
  RelativeErrors result;
  result.length_m = length_m;
  result.count = translation.size();
  result.translation = summarize(std::move(translation));
  result.rotation_deg_per_m = summarize(std::move(rotation));
  return result;
}

}  // namespace leviosim::traces
