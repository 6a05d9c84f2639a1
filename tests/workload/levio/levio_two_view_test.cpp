// The 8-point algorithm, pose recovery and triangulation of the released program: what they find,
// and their work beside that of the release. Facts: workload/PARAMETERS.md#eight-point-algorithm,
// #pose-recovery, #triangulation.
#include "tests/workload/levio/two_view_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "sim/work/machine.h"
#include "tests/support/dense_algebra.h"
#include "workload/levio/geometry/eight_point.h"
#include "workload/levio/geometry/essential_ransac.h"
#include "workload/levio/geometry/pose_matrix.h"
#include "workload/levio/geometry/pose_recovery.h"
#include "workload/levio/geometry/two_view_point.h"

namespace leviosim::vio::levio {
namespace {

using test::make_two_view_scene;
using test::TwoViewScene;
using test::TwoViewSceneOptions;
using work::Op;

constexpr double kEssentialHypotheses = 640;
constexpr float kThreshold = (0.7f / 114.66f) * (0.7f / 114.66f);

/// Pixels of a scene, as the release keeps them.
template <class P>
struct Pixels {
  using F = typename P::F32;

  explicit Pixels(const TwoViewScene& scene) {
    for (int i = 0; i < scene.n; ++i)
      for (int c = 0; c < 2; ++c) {
        const double focal = c == 0 ? test::kCamera.fx : test::kCamera.fy;
        const double centre = c == 0 ? test::kCamera.cx : test::kCamera.cy;
        a.push_back(F(static_cast<float>(scene.seen_a[i](c) * focal + centre)));
        b.push_back(F(static_cast<float>(scene.seen_b[i](c) * focal + centre)));
      }
  }
  PixelMatches<P> view() const {
    const int n = static_cast<int>(a.size());
    return {{a.data(), n}, {b.data(), n}, n / 2};
  }

  std::vector<F> a, b;
};

template <class P>
struct FoundEssential {
  EssentialResult<P> essential;
  Eigen::Matrix3d E;
  RecoveredPose<P> pose;
  std::vector<int> mask;
  work::Job job;
};

template <class P>
FoundEssential<P> estimate_essential_of(const TwoViewScene& scene, int cores = 8,
                                        const EssentialRansacOptions& options = {}) {
  work::Machine machine({cores, "L1", Bytes(110000), 1, true});
  const test::MatchStorage<P> matches(scene);
  const Pixels<P> pixels(scene);
  FoundEssential<P> found;
  {
    const auto stage = machine.stage("8-point RANSAC");
    work::Arena& local = machine.local();
    const work::Arena::Frame frame(local);
    const MatrixView<P> E = alloc_matrix<P>(local, "E", 3, 3);
    const auto mask = local.alloc<typename P::template Span<typename P::Byte>>("mask", scene.n);
    ShiftRegister<P> random(7);
    found.essential =
        estimate_essential<P>(machine, matches.view(), kThreshold, random, options, E, mask);
    for (int i = 0; i < scene.n; ++i) found.mask.push_back(static_cast<int>(mask.data()[i]));
    if (found.essential.ok)
      found.pose = recover_pose<P>(machine, E, pixels.view(), CameraConstants<P>(test::kCamera));
    for (int i = 0; i < 9; ++i)
      found.E(i / 3, i % 3) = static_cast<double>(work::value(E.data().data()[i]));
  }
  found.job = machine.take_job();
  return found;
}

/// The work of the forks of a name, or the master's between them.
work::Counts of_forks(const work::Job& job, std::string_view name) {
  work::Counts sum;
  for (const work::Step& step : job.stages.at(0).steps)
    if (const auto* fork = std::get_if<work::Fork>(&step); fork && fork->name == name)
      for (const work::Segment& share : fork->shares) sum += share;
  return sum;
}
work::Counts of_master(const work::Job& job) {
  work::Counts sum;
  for (const work::Step& step : job.stages.at(0).steps)
    if (const auto* serial = std::get_if<work::Serial>(&step)) sum += serial->counts;
  return sum;
}

/// Like the matches of the release's frames: keypoints of whole pixels, a short baseline.
TwoViewSceneOptions like_real_frames() {
  return {.matches = 60, .outliers = 0.1, .rounded = true, .depth_m = {2, 8}};
}

TEST(LevioEightPoint, FindsTheMotionAmongOutliers) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const TwoViewScene scene = make_two_view_scene(
        seed, {.matches = 100, .outliers = 0.2, .baseline_m = {0.3, 0.6}, .depth_m = {1, 6}});
    const auto result = estimate_essential_of<work::Native>(scene);
    if (!result.essential.ok || !result.pose.ok) continue;
    const bool near =
        test::degrees_between(test::to_eigen(result.pose.T_b_a.R), scene.R_b_a) < 1.5 &&
        test::degrees_between(test::to_eigen(result.pose.T_b_a.t), scene.t_b_a) < 8;
    found += near ? 1 : 0;
  }
  EXPECT_GE(found, 9);
}

TEST(LevioEightPoint, SingularValuesAreEqual) {
  const TwoViewScene scene = make_two_view_scene(3, like_real_frames());
  const Eigen::VectorXd sigma =
      tests::singular_values(estimate_essential_of<work::Native>(scene).E);
  EXPECT_NEAR(sigma(1) / sigma(0), 1, 1e-4);
  EXPECT_LT(sigma(2), 1e-3 * sigma(0));
}

TEST(LevioEightPoint, TheMotionDoesNotDependOnTheNumberOfCoresOrThePolicy) {
  const TwoViewScene scene = make_two_view_scene(5, like_real_frames());
  const auto eight = estimate_essential_of<work::Native>(scene);
  const auto one = estimate_essential_of<work::Native>(scene, 1);
  const auto counted = estimate_essential_of<work::Counting>(scene);
  EXPECT_EQ(one.E, eight.E);
  EXPECT_EQ(counted.E, eight.E);
  EXPECT_EQ(test::to_eigen(one.pose.T_b_a.R), test::to_eigen(eight.pose.T_b_a.R));
  EXPECT_EQ(test::to_eigen(counted.pose.T_b_a.t), test::to_eigen(eight.pose.T_b_a.t));
}

TEST(LevioEightPoint, AHypothesisTakesItsScratchAndNoMore) {
  const TwoViewScene scene = make_two_view_scene(8, {.matches = kEssentialSample});
  std::vector<float> a, b;
  for (int i = 0; i < scene.n; ++i)
    for (int c = 0; c < 2; ++c) {
      a.push_back(static_cast<float>(scene.seen_a[i](c)));
      b.push_back(static_cast<float>(scene.seen_b[i](c)));
    }
  const std::vector<std::uint16_t> sample{0, 1, 2, 3, 4, 5, 6, 7};
  work::Arena results("results", Bytes(64));
  work::Arena scratch("scratch", kEssentialScratch);
  essential_from_sample<work::Native>({{a.data(), 2 * scene.n}, {b.data(), 2 * scene.n}, scene.n},
                                      {sample.data(), kEssentialSample},
                                      alloc_matrix<work::Native>(results, "essential", 3, 3),
                                      scratch);
  EXPECT_EQ((scratch.peak().count() + 3) / 4 * 4, kEssentialScratch.count());
}

TEST(LevioEightPoint, TriangulationFindsThePoint) {
  const TwoViewScene scene =
      make_two_view_scene(8, {.matches = 50, .baseline_m = {0.3, 0.6}, .depth_m = {1, 4}});
  work::Arena arena("L1", Bytes(4096));
  const MatrixView<work::Native> T_a = alloc_matrix<work::Native>(arena, "a", 4, 4),
                                 T_b = alloc_matrix<work::Native>(arena, "b", 4, 4);
  store_pose<work::Native>(T_a, Pose<work::Native>::identity());
  store_pose<work::Native>(T_b, test::to_pose<work::Native>(scene.R_b_a, scene.t_b_a));
  const Pixels<work::Native> pixels(scene);
  const CameraConstants<work::Native> camera(test::kCamera);
  for (int i = 0; i < scene.n; ++i) {
    const Vec2<work::Native> a{pixels.a[2 * i], pixels.a[2 * i + 1]},
        b{pixels.b[2 * i], pixels.b[2 * i + 1]};
    work::Arena scratch("scratch", kTriangulationScratch);
    const auto point = triangulate<work::Native>(T_a, T_b, a, b, camera, scratch);
    EXPECT_EQ(scratch.peak(), kTriangulationScratch);
    EXPECT_LT((test::to_eigen(point) - scene.points_a[i]).norm(), 0.02 * scene.points_a[i].norm());
    EXPECT_LT(reprojection_error_sq<work::Native>(T_b, point, b, camera), 0.05f);
  }
}

/// OpenCV's matrix of a scene whose matches are exact.
Eigen::Matrix3d essential_of_opencv(const TwoViewScene& scene, std::vector<cv::Point2d>& a,
                                    std::vector<cv::Point2d>& b) {
  for (const auto& x : scene.seen_a) a.push_back({x.x(), x.y()});
  for (const auto& x : scene.seen_b) b.push_back({x.x(), x.y()});
  const cv::Mat found = cv::findEssentialMat(a, b, 1.0, {0, 0}, cv::RANSAC, 0.999, 1e-3);
  Eigen::Matrix3d E;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) E(r, c) = found.at<double>(r, c);
  return E;
}

TEST(LevioEightPoint, ExactMatchesGiveTheMatrixAndThePoseOfOpenCv) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const TwoViewScene scene = make_two_view_scene(seed, {.matches = 100});
    const auto found = estimate_essential_of<work::Native>(scene);
    ASSERT_TRUE(found.essential.ok && found.pose.ok);
    EXPECT_EQ(found.essential.inliers, 100);
    std::vector<cv::Point2d> a, b;
    const Eigen::Matrix3d reference = essential_of_opencv(scene, a, b);
    // Any hypothesis that fits all matches within 0.7 px may win, hence the distance.
    EXPECT_LT(test::difference_up_to_scale(found.E, reference), 0.1);
    cv::Matx33d E;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) E(r, c) = found.E(r, c);
    cv::Mat R, t;
    const int in_front = cv::recoverPose(E, a, b, R, t, 1.0, {0, 0});
    // OpenCV drops points beyond 50 baselines.
    EXPECT_GE(found.pose.in_front, in_front);
    for (int r = 0; r < 3; ++r) {
      EXPECT_NEAR(test::to_eigen(found.pose.T_b_a.t)(r), t.at<double>(r), 1e-2);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(test::to_eigen(found.pose.T_b_a.R)(r, c), R.at<double>(r, c), 1e-2);
    }
  }
}

TEST(LevioEightPoint, OutliersAreLeftOut) {
  int kept_outliers = 0, outliers = 0, kept = 0, good = 0;
  for (std::uint64_t seed = 100; seed < 105; ++seed) {
    const TwoViewScene scene =
        make_two_view_scene(seed, {.matches = 120, .outliers = 0.3, .rounded = true});
    const auto found = estimate_essential_of<work::Native>(scene);
    int marked = 0;
    for (std::size_t i = 0; i < scene.outlier.size(); ++i) {
      (scene.outlier[i] ? outliers : good) += 1;
      (scene.outlier[i] ? kept_outliers : kept) += found.mask[i];
      marked += found.mask[i];
    }
    EXPECT_EQ(marked, found.essential.inliers);
  }
  // A random match hits a band of ±0.7 px around an epipolar line in 120 rows now and then.
  EXPECT_LT(kept_outliers, 0.1 * outliers);
  EXPECT_GT(kept, 0.8 * good);
}

TEST(LevioEightPoint, MoreIterationsNeverFindFewerInliers) {
  const TwoViewScene scene =
      make_two_view_scene(5, {.matches = 100, .outliers = 0.4, .rounded = true});
  int before = 0;
  for (const int iterations : {8, 24, 96, 384}) {
    const auto found = estimate_essential_of<work::Native>(scene, 8, {.iterations = iterations});
    EXPECT_GE(found.essential.inliers, before);
    before = found.essential.inliers;
  }
}

/// Samples are drawn one after the other, whatever the forks that they are computed in.
TEST(LevioEightPoint, EachCoreHasAHypothesisAndTheBestIsTheSame) {
  const TwoViewScene scene =
      make_two_view_scene(5, {.matches = 100, .outliers = 0.4, .rounded = true});
  const auto of_eight = estimate_essential_of<work::Counting>(scene, 8, {.iterations = 40});
  for (const int cores : {1, 3, 4, 12, 16}) {
    const auto found = estimate_essential_of<work::Counting>(scene, cores, {.iterations = 40});
    EXPECT_EQ(found.essential.inliers, of_eight.essential.inliers) << cores;
    EXPECT_EQ(found.E, of_eight.E) << cores;
    EXPECT_EQ(found.mask, of_eight.mask) << cores;
    for (const work::Step& step : found.job.stages.at(0).steps)
      if (const auto* fork = std::get_if<work::Fork>(&step);
          fork && fork->name == "8-point scoring") {
        EXPECT_EQ(static_cast<int>(fork->shares.size()), cores);
        for (const work::Segment& share : fork->shares)
          EXPECT_GT(share[work::Op::F32Div], 0u) << "a core of " << cores << " has no hypothesis";
        break;  // the last fork has what is left
      }
  }
}

/// Nothing is checked on the way, so no pose is what degenerate matches have to end with, or one
/// that is a number.
TEST(LevioEightPoint, DegenerateMatchesGiveNoPoseThatIsNoNumber) {
  TwoViewScene same = make_two_view_scene(1, {.matches = 30});
  for (auto& x : same.seen_a) x = same.seen_a[0];
  for (auto& x : same.seen_b) x = same.seen_b[0];
  TwoViewScene centre = same;
  for (auto& x : centre.seen_a) x.setZero();
  for (auto& x : centre.seen_b) x.setZero();
  const TwoViewScene turned = make_two_view_scene(1, {.matches = 60, .baseline_m = {0, 0}});
  for (const TwoViewScene& scene : {same, centre, turned}) {
    const auto found = estimate_essential_of<work::Native>(scene);
    if (!found.essential.ok || !found.pose.ok) continue;
    EXPECT_TRUE(test::to_eigen(found.pose.T_b_a.R).allFinite());
    EXPECT_TRUE(test::to_eigen(found.pose.T_b_a.t).allFinite());
  }
}

/// The masks of 8 hypotheses make up most of what the cores share; see the paper's table of memory.
TEST(LevioEightPoint, CoresNeedLittleMemory) {
  const auto found = estimate_essential_of<work::Counting>(make_two_view_scene(5, {.matches = 360}),
                                                           8, {.iterations = 64});
  const work::MemoryPeak& memory = found.job.stages.at(0).memory;
  EXPECT_GT(memory.single, Bytes(8 * 360));
  EXPECT_LT((memory.parallel - memory.single).count() / 7, 1100);
}

TEST(LevioSampson, IsTheDistanceOfOpenCvOnAnyScale) {
  const TwoViewScene scene =
      make_two_view_scene(2, {.matches = 60, .outliers = 0.3, .rounded = true});
  const Eigen::Matrix3d E = scene.essential();
  cv::Matx33d F;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) F(r, c) = E(r, c);
  for (std::size_t i = 0; i < scene.seen_a.size(); ++i) {
    const Eigen::Vector2d a = scene.seen_a[i], b = scene.seen_b[i];
    const auto error_of = [&](double scale) {
      return sampson_error_sq<work::Native>(test::to_mat3<work::Native>(scale * E),
                                            test::to_vec2<work::Native>(a),
                                            test::to_vec2<work::Native>(b));
    };
    const double expected =
        cv::sampsonDistance(cv::Vec3d(a.x(), a.y(), 1), cv::Vec3d(b.x(), b.y(), 1), F);
    EXPECT_NEAR(std::sqrt(static_cast<double>(error_of(1))), std::sqrt(expected), 1e-6);
    EXPECT_EQ(error_of(-4), error_of(1));
  }
}

TEST(LevioSampson, MarksTheMatchesBelowTheThreshold) {
  const TwoViewScene scene =
      make_two_view_scene(8, {.matches = 90, .outliers = 0.4, .rounded = true});
  const test::MatchStorage<work::Native> matches(scene);
  work::Arena arena("L1", Bytes(4096));
  const MatrixView<work::Native> E = alloc_matrix<work::Native>(arena, "E", 3, 3);
  const Mat3<work::Native> exact = test::to_mat3<work::Native>(scene.essential());
  for (int i = 0; i < 9; ++i) E(i / 3, i % 3) = exact.m[i / 3][i % 3];
  const float threshold = (1.0f / test::kCamera.fx) * (1.0f / test::kCamera.fx);
  std::vector<std::uint8_t> mask(90, 77);
  int inliers = -1;
  float error_sum = -1;
  score_essential<work::Native>(E, matches.view(), threshold, {mask.data(), 90},
                                {{&inliers, 1}, {&error_sum, 1}});
  int expected = 0;
  float expected_sum = 0;
  for (int i = 0; i < 90; ++i) {
    const float error =
        sampson_error_sq<work::Native>(exact, matches.view().in_a(i), matches.view().in_b(i));
    EXPECT_EQ(mask[static_cast<std::size_t>(i)], error < threshold ? 1 : 0);
    if (error < threshold) ++expected, expected_sum += error;
    // Rounding by half a pixel in each image stays below one pixel.
    EXPECT_TRUE(error < threshold || scene.outlier[static_cast<std::size_t>(i)]);
  }
  EXPECT_EQ(inliers, expected);
  EXPECT_EQ(error_sum, expected_sum);
}

/// Facts on the release: scratch is misaligned in 74 % of the calls on eight cores and in none on
/// one.
TEST(LevioEightPoint, WordsStraddleOnATeamAndNotOnOneCore) {
  TwoViewSceneOptions options = like_real_frames();
  options.matches = 61;  // the mask in front of the scratch is no whole number of words
  const auto found = estimate_essential_of<work::Counting>(make_two_view_scene(100, options));
  ASSERT_TRUE(found.essential.ok);
  std::uint64_t on_team = 0, on_one = 0;
  for (const work::Step& step : found.job.stages.at(0).steps)
    if (const auto* fork = std::get_if<work::Fork>(&step)) {
      for (const work::Segment& share : fork->shares) on_team += share[Op::Straddle];
      on_one += work::shares_on_one_core(*fork)[Op::Straddle];
    }
  EXPECT_GT(on_team, 0u);
  EXPECT_EQ(on_one, 0u);
}

TEST(LevioEightPoint, DoesTheWorkOfTheRelease) {
  work::Counts hypotheses, scoring, recovery, master;
  double number = 0, matches = 0;
  for (std::uint64_t seed = 100; seed < 110; ++seed) {
    const TwoViewScene scene = make_two_view_scene(seed, like_real_frames());
    const auto found = estimate_essential_of<work::Counting>(scene);
    ASSERT_TRUE(found.essential.ok);
    hypotheses += of_forks(found.job, "8-point hypotheses");
    scoring += of_forks(found.job, "8-point scoring");
    recovery += of_forks(found.job, "recover pose");
    master += of_master(found.job);
    number += kEssentialHypotheses;
    matches += scene.n;
  }
  const auto of = [](const work::Counts& c, Op op, double per) {
    return static_cast<double>(c[op]) / per;
  };
  const double rotations = of(hypotheses, Op::F64Mul, 2);
  // 9 divisions of the first unit vector and 54 of a step, 12 of the SVD and one of a rotation.
  const double steps = (of(hypotheses, Op::F32Div, 1) - rotations - 21 * number) / 54 / number;
  // 4 of the first unit vector, 4 of normalised coordinates, 3 of the point, 14 of a step.
  const double steps4 = (of(recovery, Op::F32Div, 4 * matches) - 11) / 14;
  const struct {
    const char* quantity;
    double counted, fact, tolerance;
  } rows[] = {
      // How many depends on the frames: real ones have more samples that determine little.
      {"steps of 9x9 per hypothesis", steps, 6.05, 0.25},
      {"rotations per hypothesis", rotations / number, 7.4, 0.05},
      {"divisions per hypothesis at 6.05 steps",
       of(hypotheses, Op::F32Div, number) - 54 * (steps - 6.05), 355, 0.05},
      {"products in double per rotation", of(hypotheses, Op::F64Mul, rotations), 2, 0},
      {"divisions per match scored", of(scoring, Op::F32Div, kEssentialHypotheses * matches), 1, 0},
      {"roots per match scored", of(scoring, Op::F32Sqrt, 1), 0, 0},
      {"steps of 4x4 in pose recovery", steps4, 3.62, 0.2},
      {"divisions per triangulation at 4.3 steps",
       of(recovery, Op::F32Div, 4 * matches) - 14 * (steps4 - 4.3), 71, 0.05},
      {"remainders per number drawn", of(master, Op::IntDiv, 8 * number), 2, 0},
  };
  for (const auto& row : rows)
    EXPECT_NEAR(row.counted, row.fact, row.tolerance * row.fact + 1e-9) << row.quantity;
}

}  // namespace
}  // namespace leviosim::vio::levio
