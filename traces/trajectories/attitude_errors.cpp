#include "traces/trajectories/attitude_errors.h"

#include <Eigen/SVD>

#include <cmath>
#include <utility>
#include <vector>

#include "sim/base/units.h"

namespace leviosim::traces {
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

}  // namespace leviosim::traces
