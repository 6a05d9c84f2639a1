#include "traces/synthesis/recorded_motion.h"

#include <cstddef>
#include <vector>

namespace leviosim::traces {
namespace {

constexpr Eigen::Index kColumns = 7;

std::vector<double> times(std::span<const GroundTruthPose> poses, std::int64_t origin_ns) {
  std::vector<double> result;
  for (const GroundTruthPose& pose : poses)
    result.push_back(static_cast<double>(pose.t_ns - origin_ns) * 1e-9);
  return result;
}

/// Of the two quaternions of each attitude, the one nearer to that of the pose before.
Eigen::MatrixXd samples(std::span<const GroundTruthPose> poses) {
  Eigen::MatrixXd result(static_cast<Eigen::Index>(poses.size()), kColumns);
  Eigen::Vector4d before = Eigen::Vector4d::Zero();
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    const Eigen::Isometry3d& pose = poses[static_cast<std::size_t>(i)].T_world_body;
    Eigen::Vector4d q = Eigen::Quaterniond(pose.linear()).coeffs();
    if (q.dot(before) < 0) q = -q;
    before = q;
    result.row(i) << pose.translation().transpose(), q.transpose();
  }
  return result;
}

}  // namespace

RecordedMotion::RecordedMotion(std::span<const GroundTruthPose> poses, std::int64_t origin_ns,
                               double half_gain_hz)
    : spline_(times(poses, origin_ns), samples(poses), half_gain_hz) {}

MotionState RecordedMotion::at(double t_s) const {
  const SplineState spline = spline_.at(t_s);
  const Eigen::Vector4d coefficients = spline.value.tail<4>();
  const Eigen::Vector4d rate = spline.first.tail<4>();
  const double length = coefficients.norm();
  const Eigen::Quaterniond q(Eigen::Vector4d(coefficients / length));
  const Eigen::Quaterniond q_rate(Eigen::Vector4d(rate / length));
  MotionState state;
  state.T_world_body.linear() = q.toRotationMatrix();
  state.T_world_body.translation() = spline.value.head<3>();
  state.velocity = spline.first.head<3>();
  state.acceleration = spline.second.head<3>();
  // The part of the rate along q, which changes only its length, ends up in the real part.
  state.angular_velocity = 2 * (q.conjugate() * q_rate).vec();
  return state;
}

}  // namespace leviosim::traces
