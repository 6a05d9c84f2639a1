#include "traces/trajectories/end_drift.h"

#include <Eigen/SVD>

#include <cmath>
#include <cstdint>
#include <vector>

#include "sim/base/check.h"

namespace leviosim::traces {

std::optional<double> end_drift(const Evaluation& evaluation, const EndDrift& how) {
  check(how.aligned_share > 0 && how.aligned_share < 1, "some of the path is aligned, not all");
  const std::vector<MatchedPose>& poses = evaluation.poses;
  const double aligned_path = how.aligned_share * evaluation.path_length_m;
  if (poses.empty() || aligned_path < how.shortest_aligned_path) return std::nullopt;
  // Back to the estimate's own vertical, which the alignment of the whole flight has tilted.
  const Similarity& whole = evaluation.alignment;
  const auto estimated = [&](const MatchedPose& pose) -> Eigen::Vector3d {
    return whole.rotation.transpose() * (pose.estimate.translation() - whole.translation) /
           whole.scale;
  };
  std::vector<Eigen::Vector3d> from;
  std::vector<Eigen::Vector3d> to;
  for (std::size_t i = 0; i < poses.size() && evaluation.distances_m[i] <= aligned_path; ++i) {
    from.push_back(estimated(poses[i]));
    to.push_back(poses[i].truth.translation());
  }
  if (from.size() < 2) return std::nullopt;
  const Similarity start = align_points(from, to, Alignment::posyaw);
  const std::int64_t since_ns = poses.back().t_ns - std::llround(how.last_s * 1e9);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double number = 0;
  for (auto pose = poses.rbegin(); pose != poses.rend() && pose->t_ns >= since_ns; ++pose) {
    sum += start * estimated(*pose) - pose->truth.translation();
    ++number;
  }
  return sum.norm() / number;
}

}  // namespace leviosim::traces
