// The front end alone: one frame after the other, its graph open to view.
#include "workload/pipeline/front_end.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/workload/preintegration_motion.h"
#include "tests/workload/vision_runs.h"

namespace leviosim::vio::test {
namespace {

using vision_test::Features;
using work::Native;

constexpr int kWidth = 160, kHeight = 120;
const PinholeCamera kCamera{114.66f, 114.32f, 77.80f, 62.09f};
const Vector3d kAtRest(0, -9.81, 0);  ///< specific force; the camera's y axis points down

struct FrontEndTest : ::testing::Test {
  FrontEndTest()
      : profile(profile_named("levio", 1)),
        cluster({8, "L1", Bytes(1 << 20), 1, false}),
        memory("L2", Bytes(2'000'000)),
        graph(memory, GraphCapacity{}),
        front_end(profile, {kCamera, kWidth, kHeight, {1, 0, 0, 0, 1, 0, 0, 0, 1}}, cluster, memory,
                  graph) {}

  FrameReport frame(const cv::Mat& image, const Vector3d& accel = kAtRest,
                    const Vector3d& gyro = Vector3d::Zero()) {
    FrameInput input{image.data, kWidth, kHeight, frames++ > 0 ? 0.05f : 0.0f, {}};
    ImuInput sample{};
    sample.dt = 0.005f;
    for (int i = 0; i < 3; ++i) {
      sample.accel[i] = static_cast<float>(accel[i]);
      sample.gyro[i] = static_cast<float>(gyro[i]);
    }
    input.imu.assign(10, sample);
    return front_end.process(input);
  }

  KeyframeState<Native> newest() const { return graph.keyframe(graph.newest_keyframe()); }

  /// Landmarks that look like the features of `image`: where they appear from the world's origin,
  /// or, if scrambled, somewhere else.
  int add_landmarks(const cv::Mat& image, bool scrambled) {
    const Features features = vision_test::extract<Native>(image, 8, profile.extractor);
    const std::size_t n = features.size();
    graph.age_landmarks();
    for (std::size_t i = 0; i < n; ++i) {
      const auto& seen = features[scrambled ? (i * 7919 + 13) % n : i];
      const float depth = 2.0f + 0.01f * static_cast<float>(i % 97);
      const Vec3<Native> point{(static_cast<float>(seen.x) - kCamera.cx) / kCamera.fx * depth,
                               (static_cast<float>(seen.y) - kCamera.cy) / kCamera.fy * depth,
                               depth};
      graph.add_landmark(point, features[i].words);
    }
    return static_cast<int>(n);
  }

  Profile profile;
  work::Machine cluster;
  work::Arena memory;
  PoseGraph<Native> graph;
  FrontEnd<Native> front_end;
  const cv::Mat flat{kHeight, kWidth, CV_8U, cv::Scalar(100)};
  const cv::Mat picture = vision_test::rectangle_image(kWidth, kHeight, 3);
  int frames = 0;
};

TEST_F(FrontEndTest, RestStaysRest) {
  for (int i = 0; i < 10;
       ++i) {  // no features: every frame is a keyframe, placed by the IMU's word
    frame(flat);
    EXPECT_LT(eigen<Native>(newest().velocity).norm(), 1e-4) << "frame " << i;
  }
}

TEST_F(FrontEndTest, StandingStillTellsGyroBiasAndGravity) {
  const Vector3d bias(0.02, -0.03, 0.08);
  frame(flat, {4, -8, 1}, bias);  // pushed while the first frame is taken
  EXPECT_GT((eigen<Native>(graph.gravity()) + kAtRest).norm(), 3);
  for (int i = 0; i < 25; ++i) frame(flat, kAtRest, bias);
  EXPECT_LT((eigen<Native>(graph.bias().gyro) - bias).norm(), 1e-4);
  EXPECT_LT((eigen<Native>(graph.gravity()) + kAtRest).norm(), 0.02);
  EXPECT_LT((eigen<Native>(graph.bias_prior().mean.gyro) - bias).norm(), 1e-4);
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

/// What a camera sees after a turn to the right by atan(12 px / fx) = 6°, to first order.
cv::Mat turned_right(const cv::Mat& image) {
  cv::Mat turned(kHeight, kWidth, CV_8U, cv::Scalar(128));
  image(cv::Rect(12, 0, kWidth - 12, kHeight)).copyTo(turned(cv::Rect(0, 0, kWidth - 12, kHeight)));
  return turned;
}

TEST_F(FrontEndTest, TurningAloneMakesNoKeyframe) {
  frame(picture);
  const double angle = std::atan(12 / 114.66);
  // Trapezoidal steps: half of the first one is at rest.
  const FrameReport report = frame(turned_right(picture), kAtRest, {0, angle / 0.0475, 0});
  ASSERT_GE(report.frame_matches, 50);
  EXPECT_FALSE(report.keyframe);
}

TEST_F(FrontEndTest, TheSameViewWithoutATurnIsParallax) {
  frame(picture);
  const FrameReport report = frame(turned_right(picture));
  ASSERT_GE(report.frame_matches, 50);
  EXPECT_TRUE(report.keyframe);
}

}  // namespace
}  // namespace leviosim::vio::test
