// Scales of estimates whose scale is known, window by window.
#include "traces/trajectories/scale_windows.h"

#include <gtest/gtest.h>

#include <cmath>

namespace leviosim::traces {
namespace {

constexpr double kRateHz = 20;

/// A circle of 2 m radius at 1 m/s, which lasts so long. [s]
Trajectory circle(double seconds) {
  Trajectory truth;
  for (int i = 0; i <= std::lround(seconds * kRateHz); ++i) {
    const double angle = 0.5 * i / kRateHz;
    StampedPose& pose = truth.emplace_back();
    pose.t_ns = std::llround(i * 1e9 / kRateHz);
    pose.T_world_body.translation() << 2 * std::cos(angle), 2 * std::sin(angle), 0.1 * angle;
  }
  return truth;
}

/// The truth with steps of another length after so many seconds, turned and moved.
Trajectory scaled_after(const Trajectory& truth, double seconds, double scale) {
  const Eigen::AngleAxisd turned(0.7, Eigen::Vector3d(1, 2, 2).normalized());
  Trajectory estimate = truth;
  Eigen::Vector3d at(5, -3, 1);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (i > 0)
      at += (static_cast<double>(truth[i].t_ns) > seconds * 1e9 ? scale : 1) *
            (turned *
             (truth[i].T_world_body.translation() - truth[i - 1].T_world_body.translation()));
    estimate[i].T_world_body.translation() = at;
  }
  return estimate;
}

std::vector<double> scales(const Trajectory& estimate, const Trajectory& truth,
                           Alignment alignment = Alignment::se3) {
  return scales_in_windows(evaluate(estimate, truth, {.alignment = alignment}));
}

TEST(ScaleWindows, FindTheScaleOfEachWindow) {
  const Trajectory truth = circle(20.5);
  const std::vector<double> found = scales(scaled_after(truth, 9.975, 1.2), truth);
  ASSERT_EQ(found.size(), 4u) << "the last half second is no window";
  EXPECT_NEAR(found[0], 1, 1e-9);
  EXPECT_NEAR(found[1], 1, 1e-3);  // the step into the next window is not in this one
  EXPECT_NEAR(found[2], 1.2, 1e-3);
  EXPECT_NEAR(found[3], 1.2, 1e-9);
}

TEST(ScaleWindows, DoNotDependOnTheScaleOfTheAlignment) {
  const Trajectory truth = circle(10.5);
  const Trajectory estimate = scaled_after(truth, 0, 0.7);
  for (const Alignment alignment : {Alignment::se3, Alignment::sim3}) {
    const std::vector<double> found = scales(estimate, truth, alignment);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_NEAR(found[0], 0.7, 1e-9);
    EXPECT_NEAR(found[1], 0.7, 1e-9);
  }
}

TEST(ScaleWindows, AShortFlightIsOneWindow) {
  const Trajectory truth = circle(4.45);
  const std::vector<double> found = scales(scaled_after(truth, 0, 1.5), truth);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0], 1.5, 1e-9);
}

TEST(ScaleWindows, WhereTheTruthHardlyMovesThereIsNone) {
  Trajectory truth = circle(15.5);
  const Trajectory estimate = truth;
  for (StampedPose& pose : truth)
    if (pose.t_ns >= 5'000'000'000 && pose.t_ns < 10'000'000'000)
      pose.T_world_body.translation() << 0, 0, 1e-12 * static_cast<double>(pose.t_ns);
  EXPECT_EQ(scales(estimate, truth).size(), 2u);
  EXPECT_TRUE(scales_in_windows(Evaluation()).empty());
}

TEST(ScaleWindows, AGapIsNoWindow) {
  const Trajectory truth = circle(25);
  Trajectory estimate;
  for (const StampedPose& pose : truth)
    if (pose.t_ns < 5'000'000'000 || pose.t_ns >= 17'000'000'000) estimate.push_back(pose);
  const std::vector<double> found = scales(estimate, truth);
  ASSERT_EQ(found.size(), 3u) << "0 to 5, 17 to 20, 20 to 25 s";
  for (const double scale : found) EXPECT_NEAR(scale, 1, 1e-9);
}

TEST(ScaleWindows, SummaryIsThatOfASample) {
  EXPECT_FALSE(summarize_scales({}).mean);
  EXPECT_EQ(summarize_scales({1.1}).mean, 1.1);
  EXPECT_FALSE(summarize_scales({1.1}).sigma);
  const ScaleSummary three = summarize_scales({0.9, 1.0, 1.1});
  EXPECT_EQ(three.windows, 3u);
  EXPECT_NEAR(three.mean.value(), 1, 1e-12);
  EXPECT_NEAR(three.sigma.value(), 0.1, 1e-12);
}

}  // namespace
}  // namespace leviosim::traces
