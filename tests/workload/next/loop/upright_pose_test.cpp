// Poses of cameras with a known vertical: pairs, RANSAC, refinement.
#include <gtest/gtest.h>

#include <algorithm>

#include "sim/work/machine.h"
#include "tests/workload/next/loop/loop_world.h"
#include "workload/next/loop/upright_pose.h"

namespace leviosim::vio::test {
namespace {

using Native = work::Native;

/// Points around an origin, and where a camera sees them.
class UprightScene {
 public:
  /// @param wrong  matches that are wrong, of every five
  UprightScene(std::uint64_t seed, int wrong, double noise_px) {
    Random random(seed);
    T_true = {static_cast<float>(random.uniform(-3, 3)),
              {static_cast<float>(random.uniform(-1, 1)), static_cast<float>(random.uniform(-1, 1)),
               static_cast<float>(random.uniform(-1, 1))}};
    const Eigen::Isometry3d view = camera_pose(
        {0, 0, 0}, random.uniform(-3, 3), random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4));
    const Eigen::Matrix3d R_camera = view.linear().transpose();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) R.m[r][c] = static_cast<float>(R_camera(r, c));
    const Eigen::Matrix3d Rz =
        Eigen::AngleAxisd(double(T_true.yaw), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Vector3d t(double(T_true.t.x), double(T_true.t.y), double(T_true.t.z));
    for (int i = 0; i < kPoints; ++i) {
      const double u = random.uniform(5, 155), v = random.uniform(5, 115);
      const double depth = random.uniform(2, 4);
      const Eigen::Vector3d x((u - double(kCamera.cx)) / double(kCamera.fx),
                              (v - double(kCamera.cy)) / double(kCamera.fy), 1);
      const Eigen::Vector3d point = Rz.transpose() * (R_camera.transpose() * (depth * x) - t);
      for (int c = 0; c < 3; ++c) points.push_back(static_cast<float>(point[c]));
      const bool is_wrong = i % 5 < wrong;
      const double du = noise_px * normal_variate(random), dv = noise_px * normal_variate(random);
      const double other_u = random.uniform(5, 155), other_v = random.uniform(5, 115);
      pixels.push_back(static_cast<float>(is_wrong ? other_u : u + du));
      pixels.push_back(static_cast<float>(is_wrong ? other_v : v + dv));
    }
  }

  UprightInput<Native> input() {
    return {{Native::Span<const float>(points.data(), static_cast<int>(points.size())),
             Native::Span<const float>(pixels.data(), static_cast<int>(pixels.size())), kPoints},
            kCamera,
            R};
  }

  static constexpr int kPoints = 40;
  YawTransform<Native> T_true;
  Mat3<Native> R;
  std::vector<float> points, pixels;
};

double distance(const YawTransform<Native>& a, const YawTransform<Native>& b) {
  const Vec3<Native> d = a.t - b.t;
  return std::sqrt(double(dot(d, d)));
}
double turn(const YawTransform<Native>& a, const YawTransform<Native>& b) {
  return std::abs(double(wrapped<Native>(wrapped<Native>(a.yaw - b.yaw))));
}

TEST(UprightPose, OfTwoPointsIsAmongTheSolutions) {
  int solved = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    UprightScene scene(seed, 0, 0);
    const PairSolution<Native> pair = solve_pair<Native>(scene.input(), 0, 1);
    double best = 1e9;
    for (int i = 0; i < pair.count; ++i)
      best = std::min(best, distance(pair.T[i], scene.T_true) + turn(pair.T[i], scene.T_true));
    if (best < 1e-2) ++solved;
  }
  // The rest are pairs near the horizon or nearly one above the other.
  EXPECT_GE(solved, 46);
}

TEST(UprightPose, HasNoSolutionForAPointAndItself) {
  UprightScene scene(1, 0, 0);
  EXPECT_EQ(solve_pair<Native>(scene.input(), 3, 3).count, 0);
}

TEST(UprightPose, IsFoundAmongWrongMatchesAndRefined) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    UprightScene scene(seed, 2, 0.3);
    work::Machine machine({8, "L1", Bytes(1 << 17), 1, false});
    const auto stage = machine.stage("pose");
    levio::ShiftRegister<Native> random(7);
    UprightPose<Native> found = find_upright_pose<Native>(machine, scene.input(), {}, random);
    EXPECT_GE(found.inliers, 20) << seed;
    ASSERT_TRUE(refine_upright_pose<Native>(machine.local(), scene.input(), {}, found.T));
    EXPECT_LT(distance(found.T, scene.T_true), 0.1) << seed;
    EXPECT_LT(turn(found.T, scene.T_true), 0.03) << seed;
    std::vector<std::uint8_t> mask(UprightScene::kPoints);
    const Native::Span<std::uint8_t> inliers(mask.data(), UprightScene::kPoints);
    EXPECT_GE(mark_inliers<Native>(scene.input(), found.T, 2, 0.05f, inliers), 22) << seed;
    EXPECT_EQ(std::count(mask.begin(), mask.end(), 1),
              mark_inliers<Native>(scene.input(), found.T, 2, 0.05f, inliers));
  }
}

TEST(UprightPose, DoesNotDependOnTheNumberOfCores) {
  UprightScene scene(3, 2, 0.5);
  std::vector<YawTransform<Native>> found;
  for (const int cores : {1, 3, 8}) {
    work::Machine machine({cores, "L1", Bytes(1 << 17), 1, false});
    const auto stage = machine.stage("pose");
    levio::ShiftRegister<Native> random(7);
    found.push_back(find_upright_pose<Native>(machine, scene.input(), {}, random).T);
  }
  for (const YawTransform<Native>& T : found) {
    EXPECT_EQ(T.yaw, found[0].yaw);
    EXPECT_EQ(T.t.x, found[0].t.x);
  }
}

}  // namespace
}  // namespace leviosim::vio::test
