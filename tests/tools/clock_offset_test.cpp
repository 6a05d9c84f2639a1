#include "tools/app/run/clock_offset.h"

#include <gtest/gtest.h>

#include <cmath>

namespace leviosim::tools {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// The angle about an axis of a vehicle that wobbles, and its rate.
double angle_at(double t_s, double faster) { return 0.3 * std::sin(faster * t_s); }
double rate_at(double t_s, double faster) { return 0.3 * faster * std::cos(faster * t_s); }

/// @param late_ms  by which stamps of images are too late
std::vector<FrameResult> frames(int number, std::int64_t late_ms, PoseSource source) {
  std::vector<FrameResult> list;
  for (int i = 0; i < number; ++i) {
    const double t_s = 0.5 + 0.05 * i;
    FrameResult frame;
    frame.source = source;
    frame.t_ns = (500 + 50 * i + late_ms) * kMs;
    frame.pose = {frame.t_ns, Eigen::Isometry3d::Identity()};
    frame.pose.T_world_body.linear() =
        (Eigen::AngleAxisd(angle_at(t_s, 3), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(angle_at(t_s, 2), Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    list.push_back(frame);
  }
  return list;
}

/// Of the same motion, with a bias.
std::vector<traces::ImuSample> samples(int number) {
  std::vector<traces::ImuSample> list;
  for (int i = 0; i < number; ++i) {
    const double t_s = 0.005 * i, tilt = angle_at(t_s, 2);
    const double turn = rate_at(t_s, 3);
    traces::ImuSample sample{};
    sample.t_ns = 5 * kMs * i;
    sample.gyro = Eigen::Vector3d(rate_at(t_s, 2), turn * std::sin(tilt), turn * std::cos(tilt)) +
                  Eigen::Vector3d(0.02, -0.05, 0.08);
    list.push_back(sample);
  }
  return list;
}

TEST(ClockOffset, IsFoundInBothDirections) {
  for (const int late_ms : {-55, -20, 0, 3, 20, 55}) {
    const auto offset = find_clock_offset(samples(1300), frames(100, late_ms, PoseSource::Tracked));
    ASSERT_TRUE(offset) << late_ms;
    EXPECT_NEAR(offset->seconds, -1e-3 * late_ms, 1e-3);
    EXPECT_EQ(offset->is_certain(), std::abs(late_ms) >= 20) << late_ms;
  }
  EXPECT_EQ(find_clock_offset(samples(1300), frames(100, 55, PoseSource::Tracked))
                ->text()
                .substr(0, 40),
            "images follow the IMU by about 55 ms: `t");
}

TEST(ClockOffset, IsNotKnownWithoutLocatedPosesOrTurns) {
  EXPECT_FALSE(find_clock_offset(samples(1300), frames(100, 55, PoseSource::Initialising)));
  EXPECT_FALSE(find_clock_offset(samples(1300), frames(20, 55, PoseSource::Tracked)));
  EXPECT_FALSE(find_clock_offset({}, frames(100, 55, PoseSource::Tracked)));
  auto still = frames(100, 55, PoseSource::Tracked);
  auto biased = samples(1300);
  for (FrameResult& frame : still) frame.pose.T_world_body.setIdentity();
  for (traces::ImuSample& sample : biased) sample.gyro = Eigen::Vector3d(0.02, -0.05, 0.08);
  const auto offset = find_clock_offset(biased, still);
  EXPECT_FALSE(offset && offset->is_certain());
}

}  // namespace
}  // namespace leviosim::tools
