#include "traces/trajectories/trajectory_errors.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/base/check.h"
#include "sim/base/units.h"

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

namespace {

/// The rotation A with the least sum of |A estimate - truth|².
Eigen::Matrix3d best_rotation(const std::vector<MatchedPose>& poses) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const MatchedPose& pose : poses)
    sum += pose.truth.linear() * pose.estimate.linear().transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) signs.z() = -1;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

/// By how much a rotation moves the vertical.
double tilt_deg(const Eigen::Matrix3d& rotation) {
  return base::kDegreesPerRadian *
         std::atan2(std::hypot(rotation(0, 2), rotation(1, 2)), rotation(2, 2));
}

/// The angle about the vertical that explains most of a rotation.
double heading_deg(const Eigen::Matrix3d& rotation) {
  return base::kDegreesPerRadian *
         std::atan2(rotation(1, 0) - rotation(0, 1), rotation(0, 0) + rotation(1, 1));
}

}  // namespace

std::optional<AttitudeErrors> attitude_errors(const Evaluation& evaluation) {
  if (evaluation.poses.empty()) return std::nullopt;
  const Eigen::Matrix3d aligned = best_rotation(evaluation.poses);
  std::vector<double> tilts;
  std::vector<double> headings;
  for (const MatchedPose& pose : evaluation.poses) {
    const Eigen::Matrix3d error =
        aligned * pose.estimate.linear() * pose.truth.linear().transpose();
    tilts.push_back(tilt_deg(error));
    headings.push_back(heading_deg(error));
  }
  // The poses of an evaluation have its alignment applied already.
  return AttitudeErrors{.tilt_rmse_deg = summarize(tilts).rmse,
                        .heading_rmse_deg = summarize(headings).rmse,
                        .tilts_deg = std::move(tilts),
                        .headings_deg = std::move(headings),
                        .world_tilt_deg = tilt_deg(aligned * evaluation.alignment.rotation)};
}

namespace {

constexpr std::size_t kFewestPoses = 3;  // that an alignment needs

double scale_of(const std::vector<MatchedPose>& poses, std::size_t begin, std::size_t end) {
  std::vector<Eigen::Vector3d> truth;
  std::vector<Eigen::Vector3d> estimate;
  for (std::size_t i = begin; i < end; ++i) {
    truth.push_back(poses[i].truth.translation());
    estimate.push_back(poses[i].estimate.translation());
  }
  return align_points(truth, estimate, Alignment::sim3).scale;
}

}  // namespace

std::vector<double> scales_in_windows(const Evaluation& evaluation, const ScaleWindows& how) {
  check(how.window_s > 0 && how.shortest_path_m > 0, "windows have a length, paths in them too");
  const std::vector<MatchedPose>& poses = evaluation.poses;
  std::vector<double> scales;
  if (poses.empty()) return scales;
  const auto add = [&](std::size_t begin, std::size_t end) {
    const double path = evaluation.distances_m[end - 1] - evaluation.distances_m[begin];
    if (end - begin >= kFewestPoses && path >= how.shortest_path_m)
      scales.push_back(scale_of(poses, begin, end) / evaluation.alignment.scale);
  };
  const std::int64_t window_ns = std::llround(how.window_s * 1e9);
  std::size_t begin = 0;
  std::int64_t until_ns = poses.front().t_ns + window_ns;
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (; poses[i].t_ns >= until_ns; until_ns += window_ns) {
      if (begin < i) add(begin, i);
      begin = i;
    }
  if (begin == 0) add(0, poses.size());
  return scales;
}

ScaleSummary summarize_scales(const std::vector<double>& scales) {
  ScaleSummary summary;
  summary.windows = scales.size();
  const auto count = static_cast<double>(scales.size());
  if (scales.empty()) return summary;
  double sum = 0;
  for (const double scale : scales) sum += scale;
  summary.mean = sum / count;
  if (scales.size() < 2) return summary;
  double squares = 0;
  for (const double scale : scales) squares += (scale - *summary.mean) * (scale - *summary.mean);
  summary.sigma = std::sqrt(squares / (count - 1));
  return summary;
}

}  // namespace leviosim::traces
