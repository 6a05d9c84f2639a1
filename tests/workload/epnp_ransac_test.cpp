#include <opencv2/calib3d.hpp>

#include <cmath>

#include "tests/workload/epnp_scene.h"
#include "workload/geometry/pnp_ransac.h"

namespace leviosim::vio::test {
namespace {

using P = work::Native;

template <class Q = P>
PnpResult<Q> estimate(const Scene& scene, const PnpOptions& options = {}, int cores = 8,
                      work::Job* job = nullptr) {
  work::Machine machine({cores, "L1", Bytes(110000), 1, job != nullptr});
  PnpResult<Q> result;
  {
    const auto stage = machine.stage("EPnP RANSAC");
    result = estimate_pose_epnp<Q>(machine, input_of<Q>(scene), options);
    EXPECT_EQ(machine.local().used(), Bytes(0));
  }
  if (job != nullptr) *job = machine.take_job();
  return result;
}

/// A well-known solver (Levenberg-Marquardt on the reprojection error) on the true inliers.
PoseError reference_error(const Scene& scene) {
  std::vector<cv::Point3f> points;
  std::vector<cv::Point2f> pixels;
  for (int i = scene.outliers; i < scene.n; ++i) {
    points.emplace_back(scene.points[3 * i], scene.points[3 * i + 1], scene.points[3 * i + 2]);
    pixels.emplace_back(scene.pixels[2 * i], scene.pixels[2 * i + 1]);
  }
  const cv::Matx33d k(double(kCamera.fx), 0, double(kCamera.cx),  //
                      0, double(kCamera.fy), double(kCamera.cy), 0, 0, 1);
  cv::Vec3d rotation, translation;
  cv::solvePnP(points, pixels, k, cv::noArray(), rotation, translation, false, cv::SOLVEPNP_SQPNP);
  cv::solvePnP(points, pixels, k, cv::noArray(), rotation, translation, true,
               cv::SOLVEPNP_ITERATIVE);
  const Eigen::Vector3d w(rotation[0], rotation[1], rotation[2]);
  return error_against(scene, Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix(),
                       {translation[0], translation[1], translation[2]});
}

TEST(EpnpRansac, ExactMatchesGiveThePoseAndAllInliers) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Scene scene = make_scene(random, {.points = 40});
    const PnpResult<P> result = estimate(scene);
    ASSERT_TRUE(result.ok);
    EXPECT_EQ(result.inliers, 40);
    EXPECT_LT(result.mean_error_px, 0.2f);
    const PoseError error = error_against(scene, result.T_camera_world);
    EXPECT_LT(error.position_m, 0.02);
    EXPECT_LT(error.angle_deg, 0.3);
  }
}

TEST(EpnpRansac, NoisyMatchesComeCloseToAFullRefinement) {
  // Without a final refit a sample of four cannot reach the refinement over all inliers, but it
  // stays within a few of its errors.
  Random random(2);
  double ours = 0.0, reference = 0.0;
  for (int trial = 0; trial < 30; ++trial) {
    const Scene scene = make_scene(random, {.points = 80, .noise_px = 0.5});
    const PnpResult<P> result = estimate(scene);
    ASSERT_TRUE(result.ok);
    EXPECT_GT(result.inliers, 40);
    const PoseError error = error_against(scene, result.T_camera_world);
    EXPECT_LT(error.position_m, 0.15);
    EXPECT_LT(error.angle_deg, 2.5);
    ours += error.position_m / 30.0;
    reference += reference_error(scene).position_m / 30.0;
  }
  EXPECT_LT(ours, 0.05);
  EXPECT_LT(ours, 8.0 * reference);
}

TEST(EpnpRansac, FindsTheInliersAmongFortyPercentOutliers) {
  Random random(3);
  int found = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const Scene scene = make_scene(random, {.points = 100, .outliers = 0.4, .whole_pixels = true});
    const PnpResult<P> result = estimate(scene);
    found += result.ok && result.inliers >= 54 && result.inliers <= 66 &&
                     error_against(scene, result.T_camera_world).position_m < 0.15
                 ? 1
                 : 0;
  }
  EXPECT_GE(found, 40);  // a sample succeeds with probability 0.6^4 / 2, 64 are drawn
}

TEST(EpnpRansac, DoesNotDependOnTheNumberOfCores) {
  Random random(4);
  const Scene scene = make_scene(random, {.points = 50, .outliers = 0.3, .whole_pixels = true});
  const PnpResult<P> eight = estimate(scene, {}, 8);
  for (const int cores : {1, 3}) {
    const PnpResult<P> other = estimate(scene, {}, cores);
    EXPECT_EQ(other.inliers, eight.inliers);
    EXPECT_EQ(other.mean_error_px, eight.mean_error_px);
    EXPECT_EQ(to_eigen(other.T_camera_world.R), to_eigen(eight.T_camera_world.R));
    EXPECT_EQ(to_eigen(other.T_camera_world.t), to_eigen(eight.T_camera_world.t));
  }
}

TEST(EpnpRansac, FindsNoPoseWithoutEnoughMatchesOrWithoutAnyStructure) {
  Random random(5);
  EXPECT_FALSE(estimate(make_scene(random, {.points = 3})).ok);
  Scene line = make_scene(random, {.points = 30});
  for (int i = 0; i < 30; ++i)
    for (int c = 0; c < 3; ++c) line.points[3 * i + c] = static_cast<float>(i);
  EXPECT_FALSE(estimate(line).ok);
}

TEST(EpnpRansac, APoseThatFewerThanASampleAgreeWithIsNone) {
  Random random(12);
  PnpOptions options;
  options.sample = 8;
  for (int trial = 0; trial < 10; ++trial) {
    const Scene chance = make_scene(random, {.points = 10, .outliers = 1.0});
    const PnpResult<P> result = estimate(chance, options);
    EXPECT_FALSE(result.ok) << result.inliers << " of 10 matches without a pose";
  }
}

TEST(EpnpRansac, TheSeedDecidesTheSamples) {
  Random random(6);
  const Scene scene = make_scene(random, {.points = 60, .noise_px = 0.5});
  PnpOptions other;
  other.seed = 99;
  EXPECT_NE(to_eigen(estimate(scene).T_camera_world.t),
            to_eigen(estimate(scene, other).T_camera_world.t));
}

TEST(EpnpRansac, HypothesesAreParallelWorkAndScoringIsSerial) {
  Random random(7);
  const Scene scene = make_scene(random, {.points = 100, .whole_pixels = true});
  work::Job job;
  estimate<work::Counting>(scene, {}, 8, &job);
  ASSERT_EQ(job.stages.size(), 1u);
  int forks = 0;
  work::Counts parallel, serial;
  for (const work::Step& step : job.stages[0].steps) {
    if (const auto* fork = std::get_if<work::Fork>(&step)) {
      ++forks;
      EXPECT_EQ(fork->shares.size(), 8u);
      for (const work::Counts& share : fork->shares) parallel += share;
    }
    if (const auto* part = std::get_if<work::Serial>(&step)) serial += part->counts;
  }
  EXPECT_EQ(forks, 8);
  // One integer division per draw; per valid hypothesis, one division per match in front.
  EXPECT_EQ(serial[work::Op::IntDiv], 64u * 4u);
  EXPECT_LE(serial[work::Op::F32Div], 64u * 101u);
  EXPECT_GT(serial[work::Op::F32Div], 32u * 100u);
  EXPECT_EQ(serial[work::Op::F64Mul], 0u);
  // Between the 120 rotations of the null space and those plus ten for each small decomposition.
  const double rotations = static_cast<double>(parallel[work::Op::F64Mul]) / 6.0 / 64.0;
  EXPECT_GT(rotations, 120.0);
  EXPECT_LT(rotations, 120.0 + 10.0 * 4.0);
  const work::MemoryPeak& memory = job.stages[0].memory;
  EXPECT_NEAR(static_cast<double>((memory.parallel - memory.single).count()) / 7.0, 3086.0, 200.0);
}

TEST(EpnpRansac, BothPoliciesAndEveryCompilerComputeTheSameBits) {
  const std::vector<float> out = same_bits_with_both_policies([]<class Q>() {
    Random random(8);
    std::vector<float> all;
    for (int trial = 0; trial < 5; ++trial) {
      const Scene scene = make_scene(
          random, {.points = 40 + 15 * trial, .outliers = 0.1 * trial, .whole_pixels = true});
      const PnpResult<Q> result = estimate<Q>(scene);
      append(all, result.T_camera_world.R);
      append(all, result.T_camera_world.t);
      all.push_back(work::value(result.mean_error_px));
      all.push_back(static_cast<float>(result.inliers));
    }
    return all;
  });
  EXPECT_EQ(fingerprint(out), 14881709610719898277u);
}

}  // namespace
}  // namespace leviosim::vio::test
