// The optimiser with the released program's work: it finds what the shared one finds, and does the
// work of the release. Facts: workload/PARAMETERS.md#optimiser.
#include "workload/levio/optimiser/levio_optimiser.h"

#include <gtest/gtest.h>

#include "tests/support/dense_algebra.h"
#include "tests/workload/graph/optimiser_scene.h"
#include "workload/levio/optimiser/cholesky.h"

namespace leviosim::vio::levio {
namespace {

using test::OptimiserScene;
using test::OptimiserSceneOptions;
using work::Native;
using work::Op;

template <class P>
std::vector<IterationReport> optimise(OptimiserScene<P>& scene, int iterations) {
  scene.options.initial_lambda = 1e-3f;
  scene.options.min_lambda = 1e-8f;
  LmState<P> lm(scene.options);
  std::vector<IterationReport> reports;
  for (int i = 0; i < iterations; ++i) {
    const auto stage = scene.fc.stage("optimiser");
    reports.push_back(levio::optimise_once<P>(scene.fc, scene.window, lm, scene.options));
  }
  return reports;
}

TEST(LevioOptimiser, ApproachesTheTruth) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    OptimiserSceneOptions options;
    options.seed = seed;
    OptimiserScene<Native> scene(options);
    ASSERT_GT(scene.position_rms(), 0.06);
    optimise(scene, 10);
    // Not nearer: the kinematic prior contradicts a motion that accelerates.
    EXPECT_LT(scene.position_rms(), 0.05) << seed;
    EXPECT_LT(scene.rotation_rms(), 5e-3) << seed;
  }
}

TEST(LevioOptimiser, EverySystemIsPositiveDefinite) {
  OptimiserSceneOptions options;
  options.whole_pixels = true;
  OptimiserScene<Native> scene(options);
  float cost = 1e30f;
  for (const IterationReport& report : optimise(scene, 10)) {
    EXPECT_TRUE(report.positive_definite);
    EXPECT_LE(report.cost_before, cost * 1.00001f);
    cost = report.accepted ? report.cost_after : report.cost_before;
  }
}

TEST(LevioOptimiser, DoesTheWorkOfTheRelease) {
  // Landmarks and observations as in the release's windows, without outliers.
  OptimiserSceneOptions options;
  options.rotation_noise = options.position_noise = options.velocity_noise = 0;
  options.depth_noise = 0;
  options.landmarks = 318;
  options.shortest_track = 2;
  options.longest_track = 2;
  OptimiserScene<work::Counting> scene(options, true);
  work::take_tally();
  optimise(scene, 1);
  const work::Job job = scene.fc.take_job();
  const work::Counts counts = work::counts_of(job.stages.at(0));
  const double observations = 2 * 318;
  // Three projections of an observation, the factor of 72 unknowns, their substitution, an inverse
  // for each landmark. The release's biases have 48 unknowns more.
  const double divisions = 3 * observations + 72 * 71 / 2 + 2 * 72 + 318;
  EXPECT_NEAR(static_cast<double>(counts[Op::F32Div]), divisions, 0.05 * divisions);
  EXPECT_NEAR(divisions + 48 * 47 / 2, 5930, 0.05 * 5930);
  // The error of every observation is a root, whether it is an outlier or not.
  EXPECT_GE(counts[Op::F32Sqrt], 3 * observations + 72);
  EXPECT_EQ(counts[Op::F64Mul] + counts[Op::F64Add], 0u);
}

TEST(LevioOptimiser, ClearsTheRecordOfEverySlotByteByByte) {
  work::Counts counts[2];
  for (const int k : {0, 1}) {
    OptimiserSceneOptions options;
    options.landmarks = 20 + 20 * k;
    options.shortest_track = options.longest_track = 2;
    OptimiserScene<work::Counting> scene(options, true);
    optimise(scene, 1);
    counts[k] = work::counts_of(scene.fc.take_job().stages.at(0));
  }
  const auto stores = [&](int k) { return static_cast<double>(counts[k][Op::StoreStream]); };
  EXPECT_GT(stores(0), 676'000);
  EXPECT_LT(stores(1) - stores(0), 0.2 * 676'000);  // slots without a landmark are cleared, too
}

TEST(LevioOptimiser, AFactorHasADivisionPerElementBelowTheDiagonal) {
  test::TestRandom random(3);
  constexpr int n = 12;
  work::Arena arena("L2", Bytes(8192));
  const MatrixView<work::Counting> a = alloc_matrix<work::Counting>(arena, "a", n, n);
  Eigen::MatrixXd m(n, n);
  for (int i = 0; i < n * n; ++i) m(i / n, i % n) = random.uniform(-1, 1);
  const Eigen::MatrixXd spd = m * m.transpose() + Eigen::MatrixXd::Identity(n, n);
  for (int i = 0; i < n * n; ++i) a(i / n, i % n) = static_cast<float>(spd(i / n, i % n));
  const auto b = arena.alloc<work::CountedSpan<work::F32>>("b", n);
  for (int i = 0; i < n; ++i) b[i] = static_cast<float>(i);
  work::take_tally();
  ASSERT_TRUE(levio::cholesky_factor<work::Counting>(a));
  const work::Counts counts = work::take_tally();
  EXPECT_EQ(counts[Op::F32Div], n * (n - 1) / 2u);
  EXPECT_EQ(counts[Op::F32Sqrt], unsigned{n});
  levio::cholesky_solve<work::Counting>(a, b);
  const Eigen::VectorXd expected = tests::solve(spd, Eigen::VectorXd::LinSpaced(n, 0, n - 1));
  for (int i = 0; i < n; ++i) EXPECT_NEAR(double(work::value(b.data()[i])), expected(i), 1e-3);
}

TEST(LevioOptimiser, BothPoliciesComputeTheSameBits) {
  OptimiserSceneOptions options;
  options.whole_pixels = true;
  options.outliers = 0.05;
  OptimiserScene<Native> native(options);
  OptimiserScene<work::Counting> counted(options);
  optimise(native, 3);
  optimise(counted, 3);
  for (int i = 0; i < 8 * kPoseFloats; ++i)
    EXPECT_EQ(native.window.state.poses[i], work::value(counted.window.state.poses.data()[i]));
}

}  // namespace
}  // namespace leviosim::vio::levio
