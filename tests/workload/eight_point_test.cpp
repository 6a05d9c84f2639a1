#include "workload/geometry/essential_ransac.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "sim/work/machine.h"
#include "tests/workload/two_view_scene.h"

namespace leviosim::vio::test {
namespace {

using work::Counting;
using work::Native;

template <class P>
Mat3<P> solve(const TwoViewScene& scene, std::vector<std::uint16_t> sample) {
  const MatchStorage<P> matches(scene);
  work::Arena scratch("L1", Bytes(4096));
  const auto E = essential_from_sample<P>(
      matches.view(), {sample.data(), static_cast<int>(sample.size())}, {}, scratch);
  EXPECT_EQ(scratch.used(), Bytes(0));
  return E;
}

/// Well spread geometry: a wide baseline and deep scene, so that eight points determine E well.
TwoViewSceneOptions well_conditioned() {
  return {.matches = 8, .baseline_m = {0.5, 1.0}, .depth_m = {1.0, 6.0}};
}

bool is_finite(const Eigen::Matrix3d& m) { return m.allFinite(); }

TEST(EightPoint, ExactMatchesGiveTheTrueEssentialMatrix) {
  std::vector<double> errors;
  for (std::uint64_t seed = 0; seed < 101; ++seed) {
    const TwoViewScene scene = make_two_view_scene(seed, well_conditioned());
    const auto E = solve<Native>(scene, {0, 1, 2, 3, 4, 5, 6, 7});
    errors.push_back(difference_up_to_scale(to_eigen(E), scene.essential()));
  }
  // Single precision, squared by HᵀH: a few samples are badly conditioned, most are good.
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[50], 2e-3);
  EXPECT_LT(errors[80], 2e-2);
}

TEST(EightPoint, MoreMatchesThanEightAreFittedInTheLeastSquaresSense) {
  TwoViewSceneOptions options = well_conditioned();
  options.matches = 40;
  std::vector<std::uint16_t> all(40);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint16_t>(i);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TwoViewScene scene = make_two_view_scene(seed, options);
    EXPECT_LT(difference_up_to_scale(to_eigen(solve<Native>(scene, all)), scene.essential()), 2e-3);
  }
}

TEST(EightPoint, ResultIsOfRankTwo) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const TwoViewScene scene = make_two_view_scene(seed, {.matches = 8, .rounded = true});
    const auto E = to_eigen(solve<Native>(scene, {7, 6, 5, 4, 3, 2, 1, 0}));
    const Eigen::Vector3d s = E.jacobiSvd().singularValues();
    EXPECT_GT(s(1), 1e-2);
    EXPECT_LT(s(2), 1e-4);
    EXPECT_LT(s.norm(), 1.0001);
  }
}

TEST(EightPoint, DegenerateSamplesGiveFiniteMatrices) {
  TwoViewScene scene = make_two_view_scene(1, {.matches = 8});
  for (auto& x : scene.seen_a) x = scene.seen_a[0];
  for (auto& x : scene.seen_b) x = scene.seen_b[0];
  EXPECT_TRUE(is_finite(to_eigen(solve<Native>(scene, {0, 1, 2, 3, 4, 5, 6, 7}))));
  for (auto& x : scene.seen_a) x.setZero();
  for (auto& x : scene.seen_b) x.setZero();
  EXPECT_TRUE(is_finite(to_eigen(solve<Native>(scene, {0, 1, 2, 3, 4, 5, 6, 7}))));
}

TEST(EightPoint, CountingComputesTheSameBits) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TwoViewScene scene = make_two_view_scene(seed, {.matches = 8, .rounded = true});
    const auto native = solve<Native>(scene, {0, 1, 2, 3, 4, 5, 6, 7});
    const auto counted = solve<Counting>(scene, {0, 1, 2, 3, 4, 5, 6, 7});
    for (int i = 0; i < 9; ++i)
      EXPECT_EQ(std::bit_cast<std::uint32_t>(native.m[i / 3][i % 3]),
                std::bit_cast<std::uint32_t>(counted.m[i / 3][i % 3].v));
  }
}

TEST(Sampson, IsOpenCvsDistance) {
  const TwoViewScene scene =
      make_two_view_scene(2, {.matches = 60, .outliers = 0.3, .rounded = true});
  const Eigen::Matrix3d E = scene.essential();
  cv::Matx33d F;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) F(r, c) = E(r, c);
  for (std::size_t i = 0; i < scene.seen_a.size(); ++i) {
    const Eigen::Vector2d a = scene.seen_a[i], b = scene.seen_b[i];
    const double expected =
        cv::sampsonDistance(cv::Vec3d(a.x(), a.y(), 1), cv::Vec3d(b.x(), b.y(), 1), F);
    const double actual = static_cast<double>(
        sampson_error_sq<Native>(to_mat3<Native>(E), to_vec2<Native>(a), to_vec2<Native>(b)));
    EXPECT_NEAR(std::sqrt(actual), std::sqrt(expected), 1e-6);
  }
}

TEST(Sampson, DoesNotDependOnTheScaleOfTheEssentialMatrix) {
  const TwoViewScene scene = make_two_view_scene(2, {.matches = 1, .rounded = true});
  const auto a = to_vec2<Native>(scene.seen_a[0]), b = to_vec2<Native>(scene.seen_b[0]);
  const float unit = sampson_error_sq<Native>(to_mat3<Native>(scene.essential()), a, b);
  EXPECT_EQ(sampson_error_sq<Native>(to_mat3<Native>(-4 * scene.essential()), a, b), unit);
}

TEST(ScoreEssential, MarksTheMatchesBelowTheThreshold) {
  const TwoViewScene scene =
      make_two_view_scene(8, {.matches = 90, .outliers = 0.4, .rounded = true});
  const MatchStorage<Native> matches(scene);
  const Mat3<Native> E = to_mat3<Native>(scene.essential());
  const float threshold = (1.0f / kCamera.fx) * (1.0f / kCamera.fx);
  std::vector<std::uint8_t> mask(90, 77);
  const int inliers = score_essential<Native>(E, matches.view(), threshold, {mask.data(), 90});
  int expected = 0;
  for (int i = 0; i < 90; ++i) {
    const bool inlier =
        sampson_error_sq<Native>(E, matches.view().in_a(i), matches.view().in_b(i)) < threshold;
    EXPECT_EQ(mask[static_cast<std::size_t>(i)], inlier ? 1 : 0);
    expected += inlier ? 1 : 0;
    if (!scene.outlier[static_cast<std::size_t>(i)]) {
      EXPECT_TRUE(inlier) << "rounding by half a pixel in each image stays below one pixel";
    }
  }
  EXPECT_EQ(inliers, expected);
  EXPECT_GT(expected, 45);
  EXPECT_LT(expected, 75);
}

TEST(ScoreEssential, CountsOneDivisionPerMatch) {
  const TwoViewScene scene = make_two_view_scene(8, {.matches = 90});
  const MatchStorage<Counting> matches(scene);
  std::vector<work::Byte> mask(90);
  work::take_tally();
  score_essential<Counting>(to_mat3<Counting>(scene.essential()), matches.view(), 1e-5f,
                            {mask.data(), 90});
  const work::Counts counts = work::take_tally();
  EXPECT_EQ(counts[work::Op::F32Div], 90u);
  EXPECT_EQ(counts[work::Op::LoadStream], 4u * 90u);
  EXPECT_EQ(counts[work::Op::StoreStream], 90u);
}

}  // namespace
}  // namespace leviosim::vio::test
