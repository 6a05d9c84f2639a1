#include "traces/trajectories/attitude_errors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace leviosim::traces {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

Eigen::Matrix3d turn(double degrees, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(degrees * kDegree, axis).toRotationMatrix();
}

const Eigen::Vector3d kX = Eigen::Vector3d::UnitX();
const Eigen::Vector3d kZ = Eigen::Vector3d::UnitZ();

/// Attitudes that differ, on a circle.
Trajectory circle() {
  Trajectory trajectory;
  for (int i = 0; i < 40; ++i) {
    const double angle = 9.0 * i * kDegree;
    Eigen::Isometry3d pose(Eigen::Translation3d(std::cos(angle), std::sin(angle), 0.1 * i));
    pose.linear() = turn(9.0 * i, kZ) * turn(20 * std::sin(angle), kX);
    trajectory.push_back({i * 50'000'000, pose});
  }
  return trajectory;
}

/// The pose i with its attitude turned in the world.
template <class Turn>
Trajectory turned(const Trajectory& truth, const Turn& by) {
  Trajectory estimate = truth;
  for (std::size_t i = 0; i < estimate.size(); ++i)
    estimate[i].T_world_body.linear() = by(i) * truth[i].T_world_body.linear();
  return estimate;
}

TEST(AttitudeErrors, TiltAndHeadingAreToldApart) {
  const Trajectory truth = circle();
  // As often one way as the other, so that no alignment takes it away.
  const auto tilted = turned(truth, [](std::size_t i) { return turn(i % 2 == 0 ? 3 : -3, kX); });
  const AttitudeErrors tilt = attitude_errors(evaluate(tilted, truth)).value();
  EXPECT_NEAR(tilt.tilt_rmse_deg, 3, 1e-9);
  EXPECT_NEAR(tilt.heading_rmse_deg, 0, 1e-9);
  const auto swung = turned(truth, [](std::size_t i) { return turn(i % 2 == 0 ? 7 : -7, kZ); });
  const AttitudeErrors heading = attitude_errors(evaluate(swung, truth)).value();
  EXPECT_NEAR(heading.tilt_rmse_deg, 0, 1e-9);
  EXPECT_NEAR(heading.heading_rmse_deg, 7, 1e-9);
  EXPECT_TRUE(heading.is_gravity_aligned());
}

/// Positions that say nothing about the rotation, or the wrong thing, do not make good attitudes
/// bad.
TEST(AttitudeErrors, DoNotDependOnThePositions) {
  const Trajectory truth = circle();
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate)
    pose.T_world_body.translation() = turn(120, kX) * pose.T_world_body.translation();
  const Evaluation evaluation = evaluate(estimate, truth);
  EXPECT_NEAR(evaluation.rotation_rmse_deg, 120, 1e-6);
  const AttitudeErrors errors = attitude_errors(evaluation).value();
  EXPECT_NEAR(errors.tilt_rmse_deg, 0, 1e-6);
  EXPECT_NEAR(errors.heading_rmse_deg, 0, 1e-6);
  EXPECT_NEAR(errors.world_tilt_deg, 0, 1e-6);
}

TEST(AttitudeErrors, SayWhetherTheWorldStandsUpright) {
  const Trajectory truth = circle();
  const auto moved = [&](const Eigen::Matrix3d& by) {
    Trajectory estimate = truth;
    Eigen::Isometry3d transform(Eigen::Translation3d(3, 2, 1));
    transform.linear() = by;
    for (StampedPose& pose : estimate) pose.T_world_body = transform * pose.T_world_body;
    return attitude_errors(evaluate(estimate, truth)).value();
  };
  const AttitudeErrors lying = moved(turn(90, kX));
  EXPECT_NEAR(lying.world_tilt_deg, 90, 1e-6);
  EXPECT_FALSE(lying.is_gravity_aligned());
  EXPECT_NEAR(lying.tilt_rmse_deg, 0, 1e-6);
  const AttitudeErrors upright = moved(turn(130, kZ));
  EXPECT_NEAR(upright.world_tilt_deg, 0, 1e-6);
  EXPECT_TRUE(upright.is_gravity_aligned());
  EXPECT_TRUE(moved(turn(4.9, kX)).is_gravity_aligned());
  EXPECT_FALSE(moved(turn(5.1, kX)).is_gravity_aligned());
}

TEST(AttitudeErrors, NeedPoses) { EXPECT_FALSE(attitude_errors(Evaluation())); }

}  // namespace
}  // namespace leviosim::traces
