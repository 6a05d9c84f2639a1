#include "traces/trajectories/association.h"

#include <fmt/core.h>
#include <Eigen/SVD>

#include <algorithm>

namespace leviosim::traces {
namespace {

bool earlier(const StampedPose& pose, std::int64_t t_ns) { return pose.t_ns < t_ns; }

Eigen::Isometry3d interpolate(const StampedPose& a, const StampedPose& b, std::int64_t t_ns) {
  const double s = static_cast<double>(t_ns - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns);
  const Eigen::Vector3d p =
      (1 - s) * a.T_world_body.translation() + s * b.T_world_body.translation();
  const Eigen::Quaterniond from(a.T_world_body.linear());
  const Eigen::Quaterniond to(b.T_world_body.linear());
  return Eigen::Translation3d(p) * from.slerp(s, to);
}

}  // namespace

std::vector<MatchedPose> associate(const Trajectory& estimate, const Trajectory& truth,
                                   std::int64_t max_gap_ns) {
  std::vector<MatchedPose> matches;
  matches.reserve(estimate.size());
  for (const StampedPose& pose : estimate) {
    const auto right = std::lower_bound(truth.begin(), truth.end(), pose.t_ns, earlier);
    if (right == truth.end()) continue;
    if (right->t_ns == pose.t_ns) {
      matches.push_back({pose.t_ns, pose.T_world_body, right->T_world_body});
      continue;
    }
    if (right == truth.begin()) continue;
    const auto left = right - 1;
    if (std::min(pose.t_ns - left->t_ns, right->t_ns - pose.t_ns) > max_gap_ns) continue;
    matches.push_back({pose.t_ns, pose.T_world_body, interpolate(*left, *right, pose.t_ns)});
  }
  return matches;
}

std::vector<double> distances_along(const Trajectory& truth,
                                    const std::vector<MatchedPose>& matches) {
  std::vector<double> distances;
  if (matches.empty()) return distances;
  double length = 0;
  Eigen::Vector3d here = matches.front().truth.translation();
  const auto walk_to = [&](const Eigen::Isometry3d& there) {
    length += (there.translation() - here).norm();
    here = there.translation();
  };
  auto sample = std::lower_bound(truth.begin(), truth.end(), matches.front().t_ns, earlier);
  for (const MatchedPose& match : matches) {
    for (; sample != truth.end() && sample->t_ns < match.t_ns; ++sample)
      walk_to(sample->T_world_body);
    walk_to(match.truth);
    distances.push_back(length);
  }
  return distances;
}

}  // namespace leviosim::traces
