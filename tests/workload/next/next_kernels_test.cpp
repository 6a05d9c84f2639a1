// Corners between pixels, pose refinement, and the elimination of departed keyframes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "sim/work/machine.h"
#include "tests/support/dense_algebra.h"
#include "tests/workload/levio/epnp_scene.h"
#include "workload/graph/marginalisation.h"
#include "workload/next/pose_refinement.h"
#include "workload/vision/subpixel.h"

namespace leviosim::vio::test {
namespace {

using work::Counting;
using work::Native;

/// A quadrant brighter than the rest, whose corner lies at (cx, cy), blurred by the area of pixels.
std::vector<std::uint8_t> quadrant(double cx, double cy, int size) {
  std::vector<std::uint8_t> pixels;
  const auto covered = [](double edge, int at) { return std::clamp(at + 0.5 - edge, 0.0, 1.0); };
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      pixels.push_back(
          static_cast<std::uint8_t>(std::lround(50 + 150 * covered(cx, x) * covered(cy, y))));
  return pixels;
}

TEST(Subpixel, FindsTheCornerOfAQuadrant) {
  for (const double dx : {-0.4, 0.0, 0.3})
    for (const double dy : {-0.2, 0.0, 0.45}) {
      const auto pixels = quadrant(10 + dx, 10 + dy, 21);
      const Vec2<Native> offset = corner_offset<Native>({pixels.data(), 441}, 21, 10, 10, 1.5f);
      EXPECT_NEAR(static_cast<double>(offset.x), dx, 0.15);
      EXPECT_NEAR(static_cast<double>(offset.y), dy, 0.15);
    }
}

TEST(Subpixel, AKeypointWithoutACornerStays) {
  const std::vector<std::uint8_t> flat(441, 100);
  const Vec2<Native> offset = corner_offset<Native>({flat.data(), 441}, 21, 10, 10, 1.5f);
  EXPECT_EQ(offset.x, 0.0f);
  EXPECT_EQ(offset.y, 0.0f);
}

template <class P>
RefinedPose<P> refine(const Scene& scene, int cores, std::vector<typename P::Byte>* marks) {
  work::Machine machine({cores, "L1", Bytes(110000), 4, P::kCounting});
  const auto stage = machine.stage("pose refinement");
  Pose<P> start;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()) * scene.R;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) start.R.m[r][c] = static_cast<float>(R(r, c));
  start.t = {static_cast<float>(scene.t.x() + 0.02), static_cast<float>(scene.t.y()),
             static_cast<float>(scene.t.z() - 0.02)};
  RefinementOptions options;
  options.steps = 8;
  options.rotation = options.position = 1.0f;
  marks->resize(static_cast<std::size_t>(scene.n));
  return refine_pose<P>(machine, input_of<P>(scene), kCamera, start, options,
                        {marks->data(), static_cast<int>(marks->size())});
}

TEST(PoseRefinement, FindsTheTruthAndTheOutliers) {
  Random random(3);
  const Scene scene = make_scene(random, {.points = 80, .outliers = 0.2});
  std::vector<std::uint8_t> marks;
  const RefinedPose<Native> refined = refine<Native>(scene, 8, &marks);
  ASSERT_TRUE(refined.ok);
  EXPECT_NEAR(refined.inliers, scene.n - scene.outliers, 2);
  for (int i = scene.outliers; i < scene.n; ++i) EXPECT_EQ(marks[static_cast<std::size_t>(i)], 1);
  const PoseError error = error_against(scene, refined.T_camera_world);
  EXPECT_LT(error.position_m, 0.02);
  EXPECT_LT(error.angle_deg, 0.3);
}

TEST(PoseRefinement, CoresAndCountingDoNotChangeTheBits) {
  Random random(4);
  const Scene scene = make_scene(random, {.points = 61, .outliers = 0.1, .noise_px = 0.5});
  std::vector<std::uint8_t> marks;
  std::vector<work::Byte> counted_marks;
  const RefinedPose<Native> one = refine<Native>(scene, 1, &marks);
  const RefinedPose<Native> eight = refine<Native>(scene, 8, &marks);
  const RefinedPose<Counting> counted = refine<Counting>(scene, 8, &counted_marks);
  EXPECT_EQ(std::memcmp(&one.T_camera_world, &eight.T_camera_world, sizeof(Pose<Native>)), 0);
  EXPECT_EQ(std::memcmp(&counted.T_camera_world, &eight.T_camera_world, sizeof(Pose<Native>)), 0);
  EXPECT_EQ(counted.inliers, eight.inliers);
}

TEST(Elimination, IsTheSchurComplement) {
  Random random(5);
  work::Arena arena("scratch", Bytes(1 << 16));
  const ReducedSystem<Native> system(arena, 2, true, kBiasUnknowns);
  const int n = system.unknowns();
  const Eigen::MatrixXd H = random.positive_definite(n, 1.0);
  const Eigen::VectorXd b = random.matrix(n, 1);
  for (int r = 0; r < n; ++r) {
    for (int c = 0; c < n; ++c) system.matrix()(r, c) = static_cast<float>(H(r, c));
    system.vector()[r] = static_cast<float>(b[r]);
  }
  eliminate_first<Native>(system, 9);
  const int m = n - 9;
  const Eigen::MatrixXd gain = H.bottomLeftCorner(m, 9) * tests::inverse(H.topLeftCorner(9, 9));
  const Eigen::MatrixXd S = H.bottomRightCorner(m, m) - gain * H.topRightCorner(9, m);
  const Eigen::VectorXd s = b.tail(m) - gain * b.head(9);
  for (int r = 0; r < m; ++r) {
    for (int c = 0; c <= r; ++c)
      EXPECT_NEAR(static_cast<double>(system.matrix()(9 + r, 9 + c)), S(r, c), 1e-4);
    EXPECT_NEAR(static_cast<double>(system.vector()[9 + r]), s[r], 1e-4);
  }
}

}  // namespace
}  // namespace leviosim::vio::test
