// Drift of estimates whose drift is known.
#include "traces/trajectories/end_drift.h"

#include <gtest/gtest.h>

#include <cmath>

namespace leviosim::traces {
namespace {

/// Rounds of 2 m radius at 1 m/s and 20 Hz, a little up and down, of so long a path. [m]
Trajectory rounds(double path) {
  Trajectory truth;
  for (int i = 0; i <= std::lround(path * 20); ++i) {
    const double angle = 0.5 * i / 20.0;
    StampedPose& pose = truth.emplace_back();
    pose.t_ns = std::int64_t{i} * 50'000'000;
    pose.T_world_body.translation() << 2 * std::cos(angle), 2 * std::sin(angle),
        0.1 * std::sin(3 * angle);
  }
  return truth;
}

/// In another place and heading, and off by `error` from `since_s` on.
Trajectory estimate_of(const Trajectory& truth, double since_s, const Eigen::Vector3d& error) {
  const Eigen::AngleAxisd turned(0.7, Eigen::Vector3d::UnitZ());
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate) {
    Eigen::Vector3d at = pose.T_world_body.translation();
    if (static_cast<double>(pose.t_ns) >= since_s * 1e9) at += error;
    pose.T_world_body.translation() = turned * at + Eigen::Vector3d(5, -3, 1);
  }
  return estimate;
}

TEST(EndDrift, IsTheErrorOfTheEndAndNotOfAnAlignmentOfTheWhole) {
  const Trajectory truth = rounds(60);
  const Trajectory estimate = estimate_of(truth, 30, {0.3, 0, -0.4});
  for (const Alignment alignment : {Alignment::se3, Alignment::sim3, Alignment::posyaw}) {
    const Evaluation evaluation = evaluate(estimate, truth, {.alignment = alignment});
    EXPECT_LT(evaluation.translation.rmse, 0.3) << "which the alignment hides";
    EXPECT_NEAR(end_drift(evaluation).value(), 0.5, 1e-9) << name_of(alignment);
  }
}

TEST(EndDrift, IsThatOfTheLastSecond) {
  const Trajectory truth = rounds(60);
  const Evaluation half = evaluate(estimate_of(truth, 59.5, {1, 0, 0}), truth);
  // The last 11 of 21 poses, which hold the ends of both halves.
  EXPECT_NEAR(end_drift(half).value(), 11.0 / 21, 1e-9);
  EXPECT_NEAR(end_drift(half, {.last_s = 0.5}).value(), 1, 1e-9);
}

TEST(EndDrift, SeesAnEstimateThatTilts) {
  const Trajectory truth = rounds(60);
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate)
    pose.T_world_body.translation() =
        Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()) * pose.T_world_body.translation();
  const Evaluation evaluation = evaluate(estimate, truth);
  EXPECT_NEAR(evaluation.translation.rmse, 0, 1e-9);
  EXPECT_GT(end_drift(evaluation).value(), 0.02) << "gravity is known: a tilt is an error";
}

TEST(EndDrift, NeedsABeginningWithAHeading) {
  const Trajectory shorter = rounds(19), longer = rounds(21);
  EXPECT_FALSE(end_drift(evaluate(shorter, shorter)));
  EXPECT_NEAR(end_drift(evaluate(longer, longer)).value(), 0, 1e-9);
}

}  // namespace
}  // namespace leviosim::traces
