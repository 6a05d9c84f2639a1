#include "workload/math/solve.h"

#include <cmath>

#include "tests/support/dense_algebra.h"
#include "tests/workload/math/math_fixture.h"
#include "workload/math/inverse_power.h"

namespace leviosim::vio::test {
namespace {

using P = work::Native;

class Solve : public ::testing::Test {
 protected:
  work::Arena arena_{"L1", Bytes(200000)};
};

TEST_F(Solve, GaussAgreesWithEigen) {
  Random random(1);
  for (int n = 1; n <= 12; ++n)
    for (int trial = 0; trial < 10; ++trial) {
      const work::Arena::Frame frame(arena_);
      const Eigen::MatrixXd m = random.matrix(n, n) + 0.5 * Eigen::MatrixXd::Identity(n, n);
      const Eigen::VectorXd b = random.matrix(n, 1);
      const auto x = place_vector<P>(arena_, b);
      ASSERT_TRUE(solve_gauss<P>(place<P>(arena_, m), place_vector<P>(arena_, b), x));
      const Eigen::VectorXd reference = tests::solve(m, b);
      const double condition = m.norm() * tests::inverse(m).norm();
      EXPECT_LT((to_eigen_vector(x) - reference).norm(), 1e-6 * condition * reference.norm());
    }
}

TEST_F(Solve, GaussPivotsWhereTheDiagonalIsZero) {
  Eigen::MatrixXd m(3, 3);
  m << 0, 2, 0, 0, 0, 4, 8, 0, 0;
  const auto x = arena_.alloc<P::Span<float>>("x", 3);
  ASSERT_TRUE(
      solve_gauss<P>(place<P>(arena_, m), place_vector<P>(arena_, Eigen::Vector3d(2, 12, 16)), x));
  EXPECT_EQ(values(x), (std::vector<float>{2, 1, 3}));
}

TEST_F(Solve, GaussRefusesSingularMatricesUnlessToldToReplacePivots) {
  Eigen::MatrixXd m(2, 2);
  m << 1, 1, 1, 1;
  const auto b = [&] { return place_vector<P>(arena_, Eigen::Vector2d(1, 2)); };
  const auto x = arena_.alloc<P::Span<float>>("x", 2);
  EXPECT_FALSE(solve_gauss<P>(place<P>(arena_, m), b(), x));
  EXPECT_FALSE(solve_gauss<P>(place<P>(arena_, Eigen::Matrix2d::Zero()), b(), x));
  m(0, 0) = std::nan("");
  m(1, 0) = std::nan("");
  EXPECT_FALSE(solve_gauss<P>(place<P>(arena_, m), b(), x));

  m << 1, 1, 1, 1;
  ASSERT_TRUE(solve_gauss<P>(place<P>(arena_, m), b(), x, 1e-6f));
  EXPECT_NEAR(x[0] / x[1], -1.0, 1e-5);  // along the null vector
}

TEST_F(Solve, CholeskySolvesTheSystemsOfTheOptimiser) {
  Random random(4);
  for (const int n : {1, 2, 3, 9, 48, 72}) {
    const work::Arena::Frame frame(arena_);
    const Eigen::MatrixXd m = random.positive_definite(n, 1.0);
    const Eigen::VectorXd b = random.matrix(n, 1);
    const auto a = place<P>(arena_, m);
    for (int r = 0; r < n; ++r)
      for (int c = r + 1; c < n; ++c) a(r, c) = 12345.0f;
    const auto x = place_vector<P>(arena_, b);
    ASSERT_TRUE(cholesky_factor<P>(a));
    cholesky_solve<P>(a, x);
    EXPECT_LT((to_eigen_vector(x) - tests::solve(m, b)).norm(), 2e-5) << "size " << n;
    if (n > 1) {
      EXPECT_EQ(a(0, n - 1), 12345.0f) << "the upper triangle is not touched";
    }
  }
}

TEST_F(Solve, SquareByTheInverseIsTheVarianceOfALinearFunction) {
  Random random(6);
  for (const int n : {1, 13, 78}) {
    const work::Arena::Frame frame(arena_);
    const Eigen::MatrixXd m = random.positive_definite(n, 1.0);
    const Eigen::VectorXd x = random.matrix(n, 1);
    const auto a = place<P>(arena_, m);
    ASSERT_TRUE(cholesky_factor<P>(a));
    const double square = work::value(square_by_inverse<P>(a, place_vector<P>(arena_, x)));
    EXPECT_NEAR(square, x.dot(tests::solve(m, x)), 1e-4 * (1 + square)) << n;
  }
}

TEST_F(Solve, CholeskyFactorReproducesTheMatrix) {
  Random random(5);
  const Eigen::MatrixXd m = random.positive_definite(9, 0.1);
  const auto a = place<P>(arena_, m);
  ASSERT_TRUE(cholesky_factor<P>(a));
  Eigen::MatrixXd l = to_eigen(a).triangularView<Eigen::Lower>();
  l.diagonal() = l.diagonal().cwiseInverse().eval();
  EXPECT_LT((l * l.transpose() - m).norm(), 1e-5);
}

TEST_F(Solve, CholeskyRefusesIndefiniteMatrices) {
  Eigen::MatrixXd m(2, 2);
  m << 1, 2, 2, 1;
  EXPECT_FALSE(cholesky_factor<P>(place<P>(arena_, m)));
  m << 1, 1, 1, 1;
  EXPECT_FALSE(cholesky_factor<P>(place<P>(arena_, m)));
  m << std::nan(""), 0, 0, 1;
  EXPECT_FALSE(cholesky_factor<P>(place<P>(arena_, m)));
}

TEST_F(Solve, InvertsLandmarkBlocks) {
  Random random(6);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Matrix3d m = random.positive_definite(3, 0.05);
    const Eigen::Matrix3d reference = tests::inverse(m);
    Mat3<P> inverse;
    ASSERT_TRUE(invert_spd3<P>(to_mat3<P>(m), inverse));
    EXPECT_LT((to_eigen(inverse) * m - Eigen::Matrix3d::Identity()).norm(), 1e-3);
    EXPECT_LT((to_eigen(inverse) - reference).norm(), 1e-3 * reference.norm());
  }
  Mat3<P> inverse = Mat3<P>::identity();
  EXPECT_FALSE(invert_spd3<P>(Mat3<P>::zero(), inverse));
  EXPECT_FALSE(invert_spd3<P>(to_mat3<P>(Eigen::Vector3d(1, -1, -1).asDiagonal()), inverse));
  EXPECT_EQ(to_eigen(inverse), Eigen::Matrix3d::Identity());
}

TEST_F(Solve, InversePowerFindsTheSmallestEigenvector) {
  Random random(7);
  for (const int n : {3, 4, 9})
    for (int trial = 0; trial < 50; ++trial) {
      const work::Arena::Frame frame(arena_);
      // Eigenvalues 0.01, 0.5, 1, 1.5 … in a random basis.
      const Eigen::MatrixXd basis = tests::orthonormal_basis(random.matrix(n, n));
      Eigen::VectorXd lambda = Eigen::VectorXd::LinSpaced(n, 0.0, 0.5 * (n - 1));
      lambda(0) = 0.01;
      const auto a = place<P>(arena_, basis * lambda.asDiagonal() * basis.transpose());
      const auto x = arena_.alloc<P::Span<float>>("x", n);
      const Bytes used = arena_.used();
      const int steps = smallest_eigenvector<P>(a, x, arena_, 15, 1e-6f);
      EXPECT_EQ(arena_.used(), used);
      EXPECT_LT(steps, 15);
      EXPECT_NEAR(std::abs(to_eigen_vector(x).dot(basis.col(0))), 1.0, 1e-5);
      EXPECT_NEAR(to_eigen_vector(x).norm(), 1.0, 1e-6);
    }
}

TEST_F(Solve, InversePowerFindsTheNullVectorOfASingularMatrix) {
  Random random(8);
  for (const int n : {4, 9})
    for (const double scale : {1e-6, 1.0, 1e6})
      for (int trial = 0; trial < 20; ++trial) {
        const work::Arena::Frame frame(arena_);
        const Eigen::MatrixXd rows = random.matrix(n - 1, n);
        const Eigen::VectorXd null_vector = tests::null_vector(rows);
        const auto a = place<P>(arena_, scale * rows.transpose() * rows);
        const auto x = arena_.alloc<P::Span<float>>("x", n);
        smallest_eigenvector<P>(a, x, arena_, 15, 1e-6f);
        const Eigen::VectorXd sigma = tests::singular_values(rows);
        const double gap = std::pow(sigma(n - 2) / sigma(0), 2);
        EXPECT_NEAR(std::abs(to_eigen_vector(x).dot(null_vector)), 1.0, 1e-5 + 1e-12 / (gap * gap));
      }
}

TEST_F(Solve, InversePowerStopsAfterTheGivenSteps) {
  const auto a = place<P>(arena_, Random(9).positive_definite(5, 1.0));
  const auto x = arena_.alloc<P::Span<float>>("x", 5);
  EXPECT_EQ(smallest_eigenvector<P>(a, x, arena_, 4, 0.0f), 4);
}

TEST_F(Solve, BothPoliciesAndEveryCompilerComputeTheSameBits) {
  const std::vector<float> out = same_bits_with_both_policies([]<class Q>() {
    using Span = typename Q::template Span<typename Q::F32>;
    Random random(10);
    work::Arena arena("L1", Bytes(60000));
    std::vector<float> all;
    const auto keep = [&](Span span) {
      for (const float x : values(span)) all.push_back(x);
    };
    const auto x = arena.alloc<Span>("x", 9);
    const auto square = place<Q>(arena, random.matrix(9, 9));
    const auto b = place_vector<Q>(arena, random.matrix(9, 1));
    const auto a = place<Q>(arena, random.matrix(9, 9));
    solve_gauss<Q>(square, b, x);
    keep(x);
    const auto normal = alloc_matrix<Q>(arena, "normal", 9, 9);
    multiply_transposed<Q>(normal, a, a);
    smallest_eigenvector<Q>(normal, x, arena, 15, 1e-6f);
    keep(x);
    EXPECT_TRUE(cholesky_factor<Q>(normal));
    cholesky_solve<Q>(normal, x);
    keep(x);
    keep(normal.data());
    Mat3<Q> inverse;
    invert_spd3<Q>(Mat3<Q>{{{4, 1, 0.5f}, {1, 3, 0.2f}, {0.5f, 0.2f, 2}}}, inverse);
    append(all, inverse);
    return all;
  });
  EXPECT_EQ(fingerprint(out), 12651583869102519755u);
}

}  // namespace
}  // namespace leviosim::vio::test
