#include "workload/vio/triangulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "sim/work/machine.h"
#include "tests/workload/levio/two_view_scene.h"

namespace leviosim::vio::test {
namespace {

using work::Counting;
using work::Native;

constexpr float kBaseline = 0.25f;

/// Two cameras side by side: b is `baseline` to the right of a, which is the world frame.
Pose<Native> beside(float baseline) { return {Mat3<Native>::identity(), {-baseline, 0.0f, 0.0f}}; }

Triangulated<Native> triangulate_native(const Pose<Native>& T_a, const Pose<Native>& T_b,
                                        const Vec2<Native>& a, const Vec2<Native>& b) {
  work::Arena scratch("L1", kTriangulationScratch);
  const auto seen = triangulate<Native>(T_a, T_b, a, b, scratch);
  EXPECT_EQ(scratch.peak(), kTriangulationScratch);
  return seen;
}

TEST(Triangulate, StereoFollowsTheClosedFormula) {
  // Depth is baseline over disparity.
  for (float depth : {0.5f, 1.0f, 4.0f, 16.0f}) {
    const Vec2<Native> a{0.125f, -0.25f};
    const Vec2<Native> b{a.x - kBaseline / depth, a.y};
    const auto seen = triangulate_native(Pose<Native>::identity(), beside(kBaseline), a, b);
    ASSERT_TRUE(seen.valid);
    EXPECT_NEAR(seen.point.z, depth, 1e-4f * depth * depth);
    EXPECT_NEAR(seen.point.x, a.x * depth, 1e-4f * depth * depth);
    EXPECT_NEAR(seen.point.y, a.y * depth, 1e-4f * depth * depth);
  }
}

TEST(Triangulate, DisparityOfTheWrongSignLiesBehindTheCameras) {
  const auto seen = triangulate_native(Pose<Native>::identity(), beside(kBaseline), {0.0f, 0.0f},
                                       {kBaseline / 2, 0.0f});
  ASSERT_TRUE(seen.valid);
  EXPECT_NEAR(seen.point.z, -2.0f, 1e-3f);
}

TEST(Triangulate, APointIsTooFarIfItsParallaxIsWithinTheError) {
  const PinholeCamera camera{100, 100, 80, 60};
  const Pose<Native> T_a = Pose<Native>::identity(), T_b = beside(kBaseline);
  const auto seen_in_b = [](float depth) { return Vec2<Native>{0.1f - kBaseline / depth, 0.2f}; };
  const auto too_far = [&](float depth) {
    return agrees_with_infinity<Native>(T_a, T_b, {0.1f, 0.2f}, seen_in_b(depth), camera, 4.0f);
  };
  EXPECT_FALSE(too_far(kBaseline * 49));  // 100 px / 49 = 2.04 px of 2 px
  EXPECT_TRUE(too_far(kBaseline * 51));
}

TEST(Triangulate, ATurnedCameraSeesNoParallax) {
  const PinholeCamera camera{100, 100, 80, 60};
  // A quarter turn to the left: what is straight ahead of b is to the left of a.
  const Pose<Native> T_b{{{{0.0f, 0.0f, 1.0f}, {0.0f, 1.0f, 0.0f}, {-1.0f, 0.0f, 0.0f}}},
                         {0.0f, 0.0f, 0.0f}};
  const Vec2<Native> in_a{-1.0f, 0.5f};  // the ray (-1, 0.5, 1) is (1, 0.5, 1) in b
  EXPECT_TRUE(agrees_with_infinity<Native>(Pose<Native>::identity(), T_b, in_a, {1.0f, 0.5f},
                                           camera, 1.0f));
  EXPECT_FALSE(
      agrees_with_infinity<Native>(Pose<Native>::identity(), T_b, in_a, in_a, camera, 1.0f));
}

TEST(Triangulate, ExactMeasurementsGiveThePointInTheWorldFrame) {
  HostRandom random(4);
  std::vector<double> errors;  // relative to the depth
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const TwoViewScene scene = make_two_view_scene(seed, {.matches = 20, .baseline_m = {0.1, 0.3}});
    // The world frame is turned and one metre away from camera a.
    const Eigen::Matrix3d R_a_world = random.rotation(3);
    const Eigen::Vector3d t_a_world = random.direction();
    const auto T_a = to_pose<Native>(R_a_world, t_a_world);
    const auto T_b =
        to_pose<Native>(scene.R_b_a * R_a_world, scene.R_b_a * t_a_world + scene.t_b_a);
    for (std::size_t i = 0; i < scene.points_a.size(); ++i) {
      const auto seen = triangulate_native(T_a, T_b, to_vec2<Native>(scene.seen_a[i]),
                                           to_vec2<Native>(scene.seen_b[i]));
      ASSERT_TRUE(seen.valid);
      const Eigen::Vector3d in_a = R_a_world * to_eigen(seen.point) + t_a_world;
      errors.push_back((in_a - scene.points_a[i]).norm() / scene.points_a[i].norm());
    }
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 5e-5);
  EXPECT_LT(errors[errors.size() * 98 / 100], 2e-3);  // the rest lies next to the epipole
}

TEST(Triangulate, NoisyMeasurementsGiveWhatOpenCvGives) {
  int compared = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TwoViewScene scene = make_two_view_scene(seed, {.matches = 20, .rounded = true});
    cv::Mat P_a = cv::Mat::eye(3, 4, CV_64F), P_b(3, 4, CV_64F);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) P_b.at<double>(r, c) = scene.R_b_a(r, c);
      P_b.at<double>(r, 3) = scene.t_b_a(r);
    }
    const auto T_b = to_pose<Native>(scene.R_b_a, scene.t_b_a);
    for (std::size_t i = 0; i < scene.points_a.size(); ++i) {
      // Without a degree between the rays, rounding leaves the depth to chance.
      const Eigen::Vector3d ray_a = scene.R_b_a * scene.seen_a[i].homogeneous();
      if (degrees_between(ray_a, scene.seen_b[i].homogeneous()) < 1) continue;
      ++compared;
      const std::vector<cv::Point2d> a{{scene.seen_a[i].x(), scene.seen_a[i].y()}};
      const std::vector<cv::Point2d> b{{scene.seen_b[i].x(), scene.seen_b[i].y()}};
      cv::Mat x;
      cv::triangulatePoints(P_a, P_b, a, b, x);
      x.convertTo(x, CV_64F);
      const Eigen::Vector3d expected =
          Eigen::Vector3d(x.at<double>(0), x.at<double>(1), x.at<double>(2)) / x.at<double>(3);
      const auto seen =
          triangulate_native(Pose<Native>::identity(), T_b, to_vec2<Native>(scene.seen_a[i]),
                             to_vec2<Native>(scene.seen_b[i]));
      ASSERT_TRUE(seen.valid);
      EXPECT_LT((to_eigen(seen.point) - expected).norm(), 0.01 * expected.norm())
          << "scene " << seed << " point " << i;
    }
  }
  EXPECT_GT(compared, 100);
}

TEST(Triangulate, WithoutBaselineGivesNoNumberThatIsNotFinite) {
  for (float x : {0.0f, 0.1f, -0.5f}) {
    const auto seen = triangulate_native(Pose<Native>::identity(), Pose<Native>::identity(),
                                         {x, 0.2f}, {x, 0.2f});
    EXPECT_TRUE(std::isfinite(seen.point.x) && std::isfinite(seen.point.y) &&
                std::isfinite(seen.point.z));
  }
}

TEST(Triangulate, ParallelRaysAreNoPoint) {
  const auto seen =
      triangulate_native(Pose<Native>::identity(), beside(1.0f), {0.0f, 0.0f}, {0.0f, 0.0f});
  EXPECT_FALSE(seen.valid);
  EXPECT_EQ(seen.point.z, 0.0f);
}

TEST(AgreesWithView, NeedsASmallErrorAndAPositiveDepth) {
  const Pose<Native> T = Pose<Native>::identity();
  const PinholeCamera camera{100.0f, 100.0f, 0.0f, 0.0f};
  const Vec3<Native> point{0.0f, 0.0f, 2.0f};
  EXPECT_TRUE(agrees_with_view<Native>(T, point, {0.0141f, 0.0f}, camera, 2));
  EXPECT_FALSE(agrees_with_view<Native>(T, point, {0.0142f, 0.0f}, camera, 2));
  EXPECT_FALSE(agrees_with_view<Native>(T, -point, {0.0f, 0.0f}, camera, 2));
  EXPECT_FALSE(agrees_with_view<Native>(T, {0.0f, 0.0f, 0.0f}, {0.0f, 0.0f}, camera, 2));
}

TEST(Triangulate, CountingComputesTheSameBits) {
  work::Arena scratch("L1", Bytes(1024));
  const TwoViewScene scene = make_two_view_scene(3, {.matches = 50, .rounded = true});
  for (std::size_t i = 0; i < scene.points_a.size(); ++i) {
    const auto native = triangulate<Native>(
        Pose<Native>::identity(), to_pose<Native>(scene.R_b_a, scene.t_b_a),
        to_vec2<Native>(scene.seen_a[i]), to_vec2<Native>(scene.seen_b[i]), scratch);
    const auto T_b = to_pose<Counting>(scene.R_b_a, scene.t_b_a);
    const auto seen_b = to_vec2<Counting>(scene.seen_b[i]);
    const auto counted = triangulate<Counting>(Pose<Counting>::identity(), T_b,
                                               to_vec2<Counting>(scene.seen_a[i]), seen_b, scratch);
    EXPECT_EQ(native.valid, counted.valid);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(native.point.x),
              std::bit_cast<std::uint32_t>(counted.point.x.v));
    EXPECT_EQ(std::bit_cast<std::uint32_t>(native.point.z),
              std::bit_cast<std::uint32_t>(counted.point.z.v));
    EXPECT_EQ(agrees_with_view<Native>(to_pose<Native>(scene.R_b_a, scene.t_b_a), native.point,
                                       to_vec2<Native>(scene.seen_b[i]), kCamera, 2),
              agrees_with_view<Counting>(T_b, counted.point, seen_b, kCamera, 2));
  }
  EXPECT_EQ(scratch.used(), Bytes(0));
}

}  // namespace
}  // namespace leviosim::vio::test
