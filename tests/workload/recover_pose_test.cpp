#include "workload/geometry/recover_pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/calib3d.hpp>

#include "tests/workload/two_view_scene.h"
#include "workload/geometry/essential_ransac.h"

namespace leviosim::vio::test {
namespace {

using work::Counting;
using work::Native;

template <class P>
std::vector<typename P::Byte> to_mask(const std::vector<int>& inliers) {
  std::vector<typename P::Byte> mask;
  for (int inlier : inliers) mask.push_back(static_cast<typename P::Byte>(inlier));
  return mask;
}

template <class P>
TwoViewPose<P> run(const TwoViewScene& scene, const Eigen::Matrix3d& E,
                   const std::vector<int>& inliers, int cores = 8) {
  const MatchStorage<P> matches(scene);
  const std::vector<typename P::Byte> mask = to_mask<P>(inliers);
  work::Machine machine({.cores = cores});
  const auto stage = machine.stage("recover pose");
  const auto pose = recover_pose<P>(machine, matches.view(),
                                    {mask.data(), static_cast<int>(mask.size())}, to_mat3<P>(E));
  EXPECT_EQ(machine.local().used(), Bytes(0));
  return pose;
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& t) {
  Eigen::Matrix3d m;
  m << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
  return m;
}

TEST(DecomposeEssential, AllFourPosesExplainTheMatrix) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const TwoViewScene scene = make_two_view_scene(seed, {.matches = 0, .max_rotation_rad = 3.0});
    for (double sign : {1.0, -1.0}) {
      const auto poses = decompose_essential<Native>(to_mat3<Native>(sign * scene.essential()));
      int like_truth = 0;
      for (const Pose<Native>& T : poses.T_b_a) {
        const Eigen::Matrix3d R = to_eigen(T.R);
        const Eigen::Vector3d t = to_eigen(T.t);
        EXPECT_NEAR(R.determinant(), 1, 1e-4);
        EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-4);
        EXPECT_NEAR(t.norm(), 1, 1e-4);
        EXPECT_LT(difference_up_to_scale(cross_matrix(t) * R, scene.essential()), 1e-4);
        like_truth +=
            (R - scene.R_b_a).norm() < 1e-3 && (t - scene.t_b_a.normalized()).norm() < 1e-3;
      }
      EXPECT_EQ(like_truth, 1);
    }
  }
}

TEST(RecoverPose, FindsThePoseThatOpenCvFinds) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const TwoViewScene scene = make_two_view_scene(seed, {.matches = 40, .rounded = true});
    const auto pose = run<Native>(scene, scene.essential(), {});
    ASSERT_TRUE(pose.ok);
    EXPECT_LT(degrees_between(to_eigen(pose.T_b_a.R), scene.R_b_a), 0.05);
    EXPECT_LT(degrees_between(to_eigen(pose.T_b_a.t), scene.t_b_a), 0.05);

    std::vector<cv::Point2d> a, b;
    for (const auto& x : scene.seen_a) a.push_back({x.x(), x.y()});
    for (const auto& x : scene.seen_b) b.push_back({x.x(), x.y()});
    cv::Matx33d E;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) E(r, c) = scene.essential()(r, c);
    cv::Mat R, t;
    const int in_front = cv::recoverPose(E, a, b, R, t, 1.0, {0, 0});
    for (int r = 0; r < 3; ++r) {
      EXPECT_NEAR(to_eigen(pose.T_b_a.t)(r), t.at<double>(r), 1e-3);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(to_eigen(pose.T_b_a.R)(r, c), R.at<double>(r, c), 1e-3);
    }
    // OpenCV drops points beyond 50 baselines; of the others few are behind after rounding.
    EXPECT_GE(pose.in_front, in_front);
    EXPECT_GE(pose.in_front, 30);
  }
}

TEST(RecoverPose, ExactMatchesAreAllInFront) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const TwoViewScene scene = make_two_view_scene(seed, {.matches = 33});
    EXPECT_EQ(run<Native>(scene, scene.essential(), {}).in_front, 33);
  }
}

TEST(RecoverPose, LeavesOutWhatTheMaskLeavesOut) {
  const TwoViewScene scene = make_two_view_scene(3, {.matches = 20});
  std::vector<int> mask(20, 1);
  mask[0] = mask[7] = mask[19] = 0;
  EXPECT_EQ(run<Native>(scene, scene.essential(), mask).in_front, 17);
  const auto none = run<Native>(scene, scene.essential(), std::vector<int>(20, 0));
  EXPECT_FALSE(none.ok);
  EXPECT_EQ(to_eigen(none.T_b_a.R), Eigen::Matrix3d::Identity());
}

TEST(RecoverPose, ResultDoesNotDependOnTheNumberOfCores) {
  const TwoViewScene scene =
      make_two_view_scene(3, {.matches = 41, .outliers = 0.2, .rounded = true});
  const auto eight = run<Native>(scene, scene.essential(), {}, 8);
  for (int cores : {1, 3}) {
    const auto other = run<Native>(scene, scene.essential(), {}, cores);
    EXPECT_EQ(other.in_front, eight.in_front);
    EXPECT_EQ(to_eigen(other.T_b_a.R), to_eigen(eight.T_b_a.R));
    EXPECT_EQ(to_eigen(other.T_b_a.t), to_eigen(eight.T_b_a.t));
  }
}

TEST(RecoverPose, CountingComputesTheSameBits) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const TwoViewScene scene =
        make_two_view_scene(seed, {.matches = 41, .outliers = 0.2, .rounded = true});
    const auto native = run<Native>(scene, scene.essential(), {});
    const auto counted = run<Counting>(scene, scene.essential(), {});
    EXPECT_EQ(native.in_front, counted.in_front);
    EXPECT_EQ(to_eigen(native.T_b_a.R), to_eigen(counted.T_b_a.R));
    EXPECT_EQ(to_eigen(native.T_b_a.t), to_eigen(counted.T_b_a.t));
  }
}

TEST(RecoverPose, RansacAndRecoveryFindTheMotionAmongOutliers) {
  std::vector<double> rotation_errors, direction_errors;
  for (std::uint64_t seed = 0; seed < 11; ++seed) {
    const TwoViewScene scene =
        make_two_view_scene(seed, {.matches = 150, .outliers = 0.3, .rounded = true});
    const MatchStorage<Native> matches(scene);
    std::vector<std::uint8_t> mask(150);
    work::Machine machine({});
    const auto stage = machine.stage("8-point RANSAC");
    const auto essential =
        estimate_essential<Native>(machine, matches.view(), kCamera.fx, {}, {mask.data(), 150});
    ASSERT_TRUE(essential.ok);
    const auto pose =
        recover_pose<Native>(machine, matches.view(), {mask.data(), 150}, essential.E);
    ASSERT_TRUE(pose.ok);
    rotation_errors.push_back(degrees_between(to_eigen(pose.T_b_a.R), scene.R_b_a));
    direction_errors.push_back(degrees_between(to_eigen(pose.T_b_a.t), scene.t_b_a));
  }
  // Half a pixel of rounding is 0.25 degrees at this focal length, and parallax is a few pixels.
  std::sort(rotation_errors.begin(), rotation_errors.end());
  std::sort(direction_errors.begin(), direction_errors.end());
  EXPECT_LT(rotation_errors[5], 1.0);
  EXPECT_LT(rotation_errors[9], 3.0);
  EXPECT_LT(direction_errors[5], 20.0);
}

TEST(RecoverPose, DegenerateInputGivesFinitePoses) {
  const auto expect_finite = [](const TwoViewScene& scene, const Eigen::Matrix3d& E) {
    const auto pose = run<Native>(scene, E, {});
    EXPECT_TRUE(to_eigen(pose.T_b_a.R).allFinite());
    EXPECT_TRUE(to_eigen(pose.T_b_a.t).allFinite());
  };
  TwoViewScene scene = make_two_view_scene(1, {.matches = 20, .baseline_m = {0, 0}});
  expect_finite(scene, cross_matrix({1, 0, 0}) * scene.R_b_a);  // pure rotation
  expect_finite(scene, Eigen::Matrix3d::Zero());
  for (auto& x : scene.seen_a) x = scene.seen_a[0];
  for (auto& x : scene.seen_b) x = scene.seen_b[0];
  expect_finite(scene, cross_matrix({0, 1, 0}));  // all matches identical
  const auto empty =
      run<Native>(make_two_view_scene(1, {.matches = 0}), cross_matrix({1, 0, 0}), {});
  EXPECT_FALSE(empty.ok);
}

}  // namespace
}  // namespace leviosim::vio::test
