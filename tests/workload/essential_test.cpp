#include "workload/geometry/essential_ransac.h"

#include <gtest/gtest.h>

#include <bit>
#include <opencv2/calib3d.hpp>

#include "tests/workload/two_view_scene.h"

namespace leviosim::vio::test {
namespace {

using work::Counting;
using work::Native;

struct Outcome {
  bool ok;
  int inliers;
  Eigen::Matrix3d E;
  std::vector<std::uint32_t> bits;
  std::vector<int> mask;
  work::Job job;

  bool operator==(const Outcome& other) const {
    return ok == other.ok && inliers == other.inliers && bits == other.bits && mask == other.mask;
  }
};

template <class P>
Outcome run(const TwoViewScene& scene, const EssentialOptions& options,
            const work::MachineConfig& config = {}) {
  const MatchStorage<P> matches(scene);
  std::vector<typename P::Byte> mask(static_cast<std::size_t>(scene.n));
  work::Machine machine(config);
  EssentialResult<P> result;
  {
    const auto stage = machine.stage("8-point RANSAC");
    result =
        estimate_essential<P>(machine, matches.view(), kCamera.fx, options, {mask.data(), scene.n});
  }
  EXPECT_EQ(machine.local().used(), Bytes(0));
  Outcome outcome{result.ok, result.inliers, to_eigen(result.E), {}, {}, machine.take_job()};
  for (int i = 0; i < 9; ++i)
    outcome.bits.push_back(std::bit_cast<std::uint32_t>(work::value(result.E.m[i / 3][i % 3])));
  for (auto inlier : mask) outcome.mask.push_back(static_cast<int>(inlier));
  return outcome;
}

EssentialOptions brief() {
  EssentialOptions options;
  options.iterations = 64;
  return options;
}

/// Sum of the inlier mask, which must be the number of inliers.
int marked(const Outcome& outcome) {
  int sum = 0;
  for (int inlier : outcome.mask) sum += inlier;
  return sum;
}

TEST(EssentialRansac, ExactMatchesAreAllInliersOfAnEssentialMatrixLikeOpenCvs) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const TwoViewScene scene = make_two_view_scene(seed, {.matches = 100});
    const Outcome outcome = run<Native>(scene, {});
    ASSERT_TRUE(outcome.ok);
    EXPECT_EQ(outcome.inliers, 100);

    std::vector<cv::Point2d> a, b;
    for (const auto& x : scene.seen_a) a.push_back({x.x(), x.y()});
    for (const auto& x : scene.seen_b) b.push_back({x.x(), x.y()});
    const cv::Mat cv_E = cv::findEssentialMat(a, b, 1.0, {0, 0}, cv::RANSAC, 0.999, 1e-3);
    Eigen::Matrix3d reference;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) reference(r, c) = cv_E.at<double>(r, c);
    EXPECT_LT(difference_up_to_scale(reference, scene.essential()), 1e-4);
    // Any hypothesis that fits all matches within 0.7 px may win, hence the distance.
    EXPECT_LT(difference_up_to_scale(outcome.E, reference), 0.1);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double residual =
          scene.seen_b[i].homogeneous().dot(outcome.E.normalized() * scene.seen_a[i].homogeneous());
      EXPECT_LT(std::abs(residual), 0.7 / static_cast<double>(kCamera.fx));
    }
  }
}

TEST(EssentialRansac, OutliersAreLeftOut) {
  int kept_outliers = 0, outliers = 0, kept = 0, good = 0;
  for (std::uint64_t seed = 100; seed < 105; ++seed) {
    const TwoViewScene scene =
        make_two_view_scene(seed, {.matches = 120, .outliers = 0.3, .rounded = true});
    const Outcome outcome = run<Native>(scene, {});
    ASSERT_TRUE(outcome.ok);
    EXPECT_EQ(marked(outcome), outcome.inliers);
    for (std::size_t i = 0; i < scene.outlier.size(); ++i) {
      (scene.outlier[i] ? outliers : good) += 1;
      (scene.outlier[i] ? kept_outliers : kept) += outcome.mask[i];
    }
  }
  // A random match hits a band of ±0.7 px around an epipolar line in 120 rows now and then.
  EXPECT_LT(kept_outliers, 0.1 * outliers);
  EXPECT_GT(kept, 0.8 * good);
}

TEST(EssentialRansac, ResultDoesNotDependOnTheNumberOfCores) {
  const TwoViewScene scene =
      make_two_view_scene(5, {.matches = 77, .outliers = 0.3, .rounded = true});
  const Outcome eight = run<Native>(scene, brief(), {.cores = 8});
  ASSERT_TRUE(eight.ok);
  EXPECT_EQ(run<Native>(scene, brief(), {.cores = 1}), eight);
  EXPECT_EQ(run<Native>(scene, brief(), {.cores = 3}), eight);
}

TEST(EssentialRansac, CountingComputesTheSameBits) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const TwoViewScene scene =
        make_two_view_scene(seed, {.matches = 61, .outliers = 0.3, .rounded = true});
    EXPECT_EQ(run<Counting>(scene, brief()), run<Native>(scene, brief()));
  }
}

TEST(EssentialRansac, MoreIterationsNeverFindFewerInliers) {
  const TwoViewScene scene =
      make_two_view_scene(5, {.matches = 100, .outliers = 0.4, .rounded = true});
  int before = 0;
  for (int iterations : {8, 24, 96, 384}) {
    EssentialOptions options;
    options.iterations = iterations;
    const int inliers = run<Native>(scene, options).inliers;
    EXPECT_GE(inliers, before);
    before = inliers;
  }
}

TEST(EssentialRansac, BatchSizeChangesOnlyWhenTheMasterDecides) {
  const TwoViewScene scene =
      make_two_view_scene(5, {.matches = 50, .outliers = 0.3, .rounded = true});
  EssentialOptions options = brief();
  const Outcome expected = run<Native>(scene, options);
  for (int batch : {1, 5, 64, 100}) {
    options.batch = batch;
    EXPECT_EQ(run<Native>(scene, options), expected) << "batch of " << batch;
  }
}

TEST(EssentialRansac, SeedChangesTheSamples) {
  const TwoViewScene scene =
      make_two_view_scene(5, {.matches = 50, .outliers = 0.3, .rounded = true});
  EssentialOptions options = brief();
  const Outcome first = run<Native>(scene, options);
  options.seed = 77;
  EXPECT_NE(run<Native>(scene, options).bits, first.bits);
}

TEST(EssentialRansac, TooFewMatchesAreNotOk) {
  for (int n : {0, 1, 7}) {
    const Outcome outcome = run<Native>(make_two_view_scene(1, {.matches = n}), {});
    EXPECT_FALSE(outcome.ok);
    EXPECT_EQ(outcome.inliers, 0);
    EXPECT_EQ(marked(outcome), 0);
    EXPECT_EQ(outcome.E, Eigen::Matrix3d::Zero());
  }
  EXPECT_TRUE(run<Native>(make_two_view_scene(1, {.matches = 8}), brief()).ok);
}

TEST(EssentialRansac, IdenticalMatchesGiveNoNumberThatIsNotFinite) {
  TwoViewScene scene = make_two_view_scene(1, {.matches = 30});
  for (auto& x : scene.seen_a) x = scene.seen_a[0];
  for (auto& x : scene.seen_b) x = scene.seen_b[0];
  EXPECT_TRUE(run<Native>(scene, brief()).E.allFinite());
  for (auto& x : scene.seen_a) x.setZero();
  for (auto& x : scene.seen_b) x.setZero();
  EXPECT_TRUE(run<Native>(scene, brief()).E.allFinite());
}

TEST(EssentialRansac, PureRotationIsFittedByAFiniteMatrix) {
  const TwoViewScene scene = make_two_view_scene(1, {.matches = 60, .baseline_m = {0, 0}});
  const Outcome outcome = run<Native>(scene, brief());
  EXPECT_TRUE(outcome.ok);
  EXPECT_TRUE(outcome.E.allFinite());
  EXPECT_EQ(outcome.inliers, 60);
}

TEST(EssentialRansac, EveryBatchForksForHypothesesAndForScores) {
  const TwoViewScene scene = make_two_view_scene(5, {.matches = 50});
  const Outcome outcome = run<Counting>(scene, {}, {.record = true});
  int hypotheses = 0, scoring = 0;
  std::uint64_t divisions_in_scoring = 0;
  for (const work::Step& step : outcome.job.stages.at(0).steps) {
    const auto* fork = std::get_if<work::Fork>(&step);
    if (fork == nullptr) continue;
    ASSERT_EQ(fork->shares.size(), 8u);
    hypotheses += fork->name == "8-point hypotheses";
    if (fork->name != "8-point scoring") continue;
    ++scoring;
    for (const work::Counts& share : fork->shares) {
      EXPECT_EQ(share[work::Op::F32Div], 50u);
      divisions_in_scoring += share[work::Op::F32Div];
    }
  }
  EXPECT_EQ(hypotheses, 80);
  EXPECT_EQ(scoring, 80);
  EXPECT_EQ(divisions_in_scoring, 640u * 50u);
}

TEST(EssentialRansac, PackedMemoryStraddlesWordsButGivesTheSameResult) {
  const TwoViewScene scene =
      make_two_view_scene(5, {.matches = 51, .outliers = 0.3, .rounded = true});
  const Outcome packed = run<Counting>(scene, brief(), {.alignment = 1, .record = true});
  const Outcome aligned = run<Counting>(scene, brief(), {.alignment = 4, .record = true});
  EXPECT_EQ(packed, aligned);
  const auto straddles = [](const Outcome& outcome) {
    work::Counts sum;
    for (const work::Step& step : outcome.job.stages.at(0).steps)
      if (const auto* fork = std::get_if<work::Fork>(&step))
        for (const work::Counts& share : fork->shares) sum += share;
    return sum[work::Op::Straddle];
  };
  EXPECT_EQ(straddles(aligned), 0u);
  EXPECT_GT(straddles(packed), 0u);
}

TEST(EssentialRansac, CoresNeedLittleScratch) {
  const work::MemoryPeak memory =
      run<Counting>(make_two_view_scene(5, {.matches = 360}), brief(), {.record = true})
          .job.stages.at(0)
          .memory;
  // The masks of 8 hypotheses make up most of the shared part; see the memory table of the paper.
  EXPECT_GT(memory.single, Bytes(8 * 360));
  EXPECT_LT(memory.single, Bytes(6000));
  const Bytes per_core{(memory.parallel - memory.single).count() / 7};
  EXPECT_LT(per_core, Bytes(1100));
}

}  // namespace
}  // namespace leviosim::vio::test
