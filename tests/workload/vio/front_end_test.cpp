// The front end alone: one frame after the other, its graph open to view.
#include "workload/levio/levio_front_end.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/workload/vio/front_end_fixture.h"

namespace leviosim::vio::test {
namespace {

struct FrontEndTest : ::testing::Test, FrontEndAlone {};

TEST_F(FrontEndTest, RestStaysRest) {
  for (int i = 0; i < 10;
       ++i) {  // no features: every frame is a keyframe, placed by the IMU's word
    frame(flat);
    EXPECT_LT(to_eigen<Native>(newest().velocity).norm(), 1e-4) << "frame " << i;
  }
}

TEST_F(FrontEndTest, StandingStillTellsGyroBiasAndGravity) {
  const Vector3d bias(0.02, -0.03, 0.08);
  frame(flat, {4, -8, 1}, bias);  // pushed while the first frame is taken
  EXPECT_GT((to_eigen<Native>(graph.gravity()) + kAtRest).norm(), 3);
  for (int i = 0; i < 25; ++i) frame(flat, kAtRest, bias);
  EXPECT_LT((to_eigen<Native>(graph.bias().gyro) - bias).norm(), 1e-4);
  EXPECT_LT((to_eigen<Native>(graph.gravity()) + kAtRest).norm(), 0.02);
  EXPECT_LT((to_eigen<Native>(graph.bias_prior().mean.gyro) - bias).norm(), 1e-4);
}

TEST_F(FrontEndTest, EnoughWorldMatchesMeanEpnp) {
  frame(picture);
  ASSERT_GE(add_landmarks(picture, false), 100);
  const FrameReport report = frame(picture);
  EXPECT_EQ(report.source, PoseSource::Epnp);
  EXPECT_GE(report.inliers, 50);
  for (float coordinate : report.p_world_camera) EXPECT_NEAR(coordinate, 0.0f, 0.02f);
}

TEST_F(FrontEndTest, AnUnsupportedEpnpPoseGivesWayToThePrediction) {
  frame(picture);
  ASSERT_GE(add_landmarks(picture, true), 100);
  graph.set_keyframe(graph.newest_keyframe(), {Pose<Native>::identity(), {0.4f, 0.0f, -0.2f}});
  const FrameReport report = frame(picture, kAtRest + Vector3d(0, 0, 8), {0, 0.2, 0});
  EXPECT_EQ(report.source, PoseSource::Predicted);
  EXPECT_LT(report.inliers, profile.min_epnp_inliers);
  EXPECT_NEAR(report.p_world_camera[0], 0.4f * 0.05f, 1e-3f);
  EXPECT_NEAR(report.p_world_camera[1], 0.0f, 1e-3f);
  EXPECT_NEAR(report.p_world_camera[2], -0.2f * 0.05f + 4 * 0.05f * 0.05f, 1e-3f);
  EXPECT_NEAR(report.R_world_camera[2], 0.2f * 0.05f, 1e-3f);  // turned about y
}

TEST_F(FrontEndTest, WithoutWorldMatchesTheTwoViewsDecide) {
  frame(picture);
  const FrameReport report = frame(picture);
  EXPECT_EQ(report.world_matches, 0);
  EXPECT_NE(report.source, PoseSource::Epnp);
  EXPECT_NE(report.source, PoseSource::Predicted);
}

/// The release compares where features are, whatever moved them.
TEST_F(FrontEndTest, TurningAloneMakesNoKeyframeButInTheRelease) {
  for (const bool released : {false, true}) {
    FrontEndAlone alone;
    alone.profile.released = released;
    alone.frame(picture);
    const double angle = std::atan(12 / 114.66);
    // Trapezoidal steps: half of the first one is at rest.
    const FrameReport report = alone.frame(turned_right(picture), kAtRest, {0, angle / 0.0475, 0});
    ASSERT_GE(report.frame_matches, 50);
    EXPECT_EQ(report.keyframe, released);
  }
}

TEST_F(FrontEndTest, TheSameViewWithoutATurnIsParallax) {
  frame(picture);
  const FrameReport report = frame(turned_right(picture));
  ASSERT_GE(report.frame_matches, 50);
  EXPECT_TRUE(report.keyframe);
}

}  // namespace
}  // namespace leviosim::vio::test
