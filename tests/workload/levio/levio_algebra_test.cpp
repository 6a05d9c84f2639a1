// The algebra of the released program against Eigen, and what it costs in the operations that no
// compiler can save. Facts: workload/PARAMETERS.md#linear-algebra, #double-precision.

#include "tests/support/dense_algebra.h"
#include "tests/workload/math/math_fixture.h"
#include "workload/levio/geometry/jacobi.h"
#include "workload/levio/geometry/least_squares.h"
#include "workload/levio/geometry/levio_inverse_power.h"
#include "workload/levio/geometry/svd.h"

namespace leviosim::vio::levio {
namespace {

using test::place;
using test::place_vector;
using test::to_eigen;
using test::to_eigen_vector;
using work::Op;
using P = work::Native;
using C = work::Counting;

TEST(LevioAlgebra, ProductsTransposeAsTheyAreTold) {
  test::Random random(1);
  work::Arena arena("L1", Bytes(8192));
  const Eigen::MatrixXd a = random.matrix(4, 7), b = random.matrix(4, 5);
  const MatrixView<P> c = alloc_matrix<P>(arena, "c", 7, 5), d = alloc_matrix<P>(arena, "d", 5, 7);
  const MatrixView<P> a_view = place<P>(arena, a), b_view = place<P>(arena, b);
  product<P>(c, transposed<P>(a_view), plain<P>(b_view));
  EXPECT_LT((to_eigen(c) - a.transpose() * b).norm(), 1e-5);
  const MatrixView<P> a_t = place<P>(arena, a.transpose());
  product<P>(d, transposed<P>(b_view), transposed<P>(a_t));
  EXPECT_LT((to_eigen(d) - b.transpose() * a).norm(), 1e-5);
}

TEST(LevioAlgebra, AVectorIsMultipliedAsAMatrixOfOneColumn) {
  test::Random random(4);
  work::Arena arena("L1", Bytes(8192));
  const Eigen::MatrixXd a = random.matrix(4, 3), v = random.matrix(3, 1), w = random.matrix(4, 1);
  const MatrixView<P> a_view = place<P>(arena, a);
  const auto x = place_vector<P>(arena, v), y = place_vector<P>(arena, Eigen::VectorXd::Zero(4));
  product_with_vector<P>(y, plain<P>(a_view), x);
  EXPECT_LT((to_eigen_vector(y) - a * v).norm(), 1e-5);
  const auto from = place_vector<P>(arena, w),
             to = place_vector<P>(arena, Eigen::VectorXd::Zero(3));
  product_with_vector<P>(to, transposed<P>(a_view), from);
  EXPECT_LT((to_eigen_vector(to) - a.transpose() * w).norm(), 1e-5);
}

TEST(LevioAlgebra, JacobiFindsEigenvectors) {
  test::Random random(2);
  for (const int n : {3, 9, 12}) {
    work::Arena arena("L1", Bytes(8192));
    const Eigen::MatrixXd a = random.symmetric(n);
    const MatrixView<P> diagonal = place<P>(arena, a), v = alloc_matrix<P>(arena, "v", n, n);
    EXPECT_GT(jacobi_eigen<P>(diagonal, v, 1000, 1e-6f), 2);
    const Eigen::MatrixXd values = to_eigen(diagonal).diagonal().asDiagonal();
    EXPECT_LT((to_eigen(v) * values * to_eigen(v).transpose() - a).norm(), 3e-5) << n;
  }
}

TEST(LevioAlgebra, ARotationTakesTheEmulatedOperationsOfTheRelease) {
  test::Random random(3);
  work::Arena arena("L1", Bytes(8192));
  const MatrixView<C> a = place<C>(arena, random.symmetric(12)),
                      v = alloc_matrix<C>(arena, "v", 12, 12);
  work::take_tally();
  jacobi_eigen<C>(a, v, 20, 0.0f);
  const work::Counts counts = work::take_tally();
  EXPECT_EQ(counts[Op::F64Mul], 20u * 2);
  EXPECT_EQ(counts[Op::F64Add], 20u * 5);
  EXPECT_EQ(counts[Op::F64Convert], 20u * 9);
  EXPECT_EQ(counts[Op::F64Div] + counts[Op::F64Compare], 0u);
  EXPECT_GE(counts[Op::F32Div], 20u);  // of the arc tangent, which divides twice where it reduces
  EXPECT_LE(counts[Op::F32Div], 20u * 2);
  EXPECT_EQ(counts[Op::F32Sqrt], 0u);
}

TEST(LevioAlgebra, AMatrixThatIsNoNumberTakesOneRotation) {
  work::Arena arena("L1", Bytes(8192));
  const MatrixView<P> a = alloc_matrix<P>(arena, "a", 12, 12),
                      v = alloc_matrix<P>(arena, "v", 12, 12);
  fill<P>(a, std::nanf(""));
  EXPECT_EQ(jacobi_eigen<P>(a, v, 120, 1e-8f), 1);
}

TEST(LevioAlgebra, SingularValuesAreThoseOfEigen) {
  test::Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    work::Arena arena("L1", Bytes(8192));
    const Eigen::MatrixXd a = random.matrix(3, 3);
    const Eigen::VectorXd expected = tests::singular_values(a);
    if (expected(2) < 0.05) continue;
    const MatrixView<P> u = alloc_matrix<P>(arena, "u", 3, 3),
                        v = alloc_matrix<P>(arena, "v", 3, 3);
    const auto s = arena.alloc<P::Span<float>>("s", 3);
    const Bytes used = arena.used();
    svd<P>(place<P>(arena, a), u, s, v, arena);
    EXPECT_GT(arena.used(), used);  // the matrix that was placed, nothing else
    EXPECT_LT((to_eigen_vector(s) - expected).norm(), 1e-4);
    const Eigen::MatrixXd U = to_eigen(u), V = to_eigen(v);
    EXPECT_LT((U * to_eigen_vector(s).asDiagonal() * V.transpose() - a).norm(), 2e-4);
    EXPECT_LT((U.transpose() * U - Eigen::Matrix3d::Identity()).norm(), 1e-5);
  }
}

TEST(LevioAlgebra, LeastSquaresAreThoseOfEigen) {
  test::Random random(5);
  for (const int n : {3, 4, 5}) {
    work::Arena arena("L1", Bytes(8192));
    const Eigen::MatrixXd a = random.matrix(6, n);
    const Eigen::VectorXd b = random.matrix(6, 1);
    const auto x = arena.alloc<P::Span<float>>("x", n);
    least_squares<P>(place<P>(arena, a), place_vector<P>(arena, b), x);
    EXPECT_LT((to_eigen_vector(x) - tests::least_squares(a, b)).norm(), 1e-4) << n;
  }
}

TEST(LevioAlgebra, AQrOf6By4HasTheDivisionsAndRootsOfTheRelease) {
  test::Random random(6);
  work::Arena arena("L1", Bytes(8192));
  const MatrixView<C> a = place<C>(arena, random.matrix(6, 4));
  const auto b = place_vector<C>(arena, random.matrix(6, 1));
  const auto x = arena.alloc<C::Span<work::F32>>("x", 4);
  work::take_tally();
  least_squares<C>(a, b, x);
  const work::Counts counts = work::take_tally();
  EXPECT_EQ(counts[Op::F32Div], 22u);
  EXPECT_EQ(counts[Op::F32Sqrt], 8u);
}

/// A positive semi-definite matrix with a gap below its second smallest eigenvalue.
Eigen::MatrixXd with_small_eigenvalue(test::Random& random, int n, double smallest) {
  const Eigen::MatrixXd q = tests::orthonormal_basis(random.matrix(n, n));
  Eigen::VectorXd values(n);
  for (int i = 0; i < n; ++i) values(i) = i == 0 ? smallest : random.uniform(0.2, 2.0);
  return q * values.asDiagonal() * q.transpose();
}

TEST(LevioAlgebra, InversePowerFindsTheSmallestEigenvector) {
  test::Random random(7);
  for (const int n : {4, 9})
    for (int trial = 0; trial < 30; ++trial) {
      work::Arena arena("L1", Bytes(8192));
      const Eigen::MatrixXd a = with_small_eigenvalue(random, n, 1e-3);
      const auto x = arena.alloc<P::Span<float>>("x", n);
      EXPECT_LE(smallest_eigenvector<P>(place<P>(arena, a), x), kMostPowerSteps);
      const Eigen::VectorXd expected = tests::symmetric_eigen(a).vectors.col(0);
      EXPECT_GT(std::fabs(to_eigen_vector(x).dot(expected)), 0.99999);
    }
}

TEST(LevioAlgebra, AStepOfInversePowerHasTheDivisionsAndRootsOfTheRelease) {
  test::Random random(8);
  for (const int n : {4, 9}) {
    work::Arena arena("L1", Bytes(8192));
    const MatrixView<C> a = place<C>(arena, with_small_eigenvalue(random, n, 1e-2));
    const auto x = arena.alloc<C::Span<work::F32>>("x", n);
    work::take_tally();
    const int steps = smallest_eigenvector<C>(a, x);
    const work::Counts counts = work::take_tally();
    const int per_step = n == 9 ? 54 : 14;
    EXPECT_EQ(counts[Op::F32Div], static_cast<unsigned>(n + per_step * steps));
    EXPECT_EQ(counts[Op::F32Sqrt], static_cast<unsigned>(1 + steps));
  }
}

TEST(LevioAlgebra, AVanishingPivotEndsInversePowerWithoutAResult) {
  work::Arena arena("L1", Bytes(8192));
  const MatrixView<P> a = place<P>(arena, Eigen::MatrixXd::Zero(4, 4));
  const auto x = arena.alloc<P::Span<float>>("x", 4);
  EXPECT_EQ(smallest_eigenvector<P>(a, x), 1);
  EXPECT_TRUE(std::isnan(x[0]));
}

TEST(LevioAlgebra, BothPoliciesComputeTheSameBits) {
  test::same_bits_with_both_policies([]<class Q>() {
    test::Random random(9);
    work::Arena arena("L1", Bytes(8192));
    const MatrixView<Q> u = alloc_matrix<Q>(arena, "u", 3, 3),
                        v = alloc_matrix<Q>(arena, "v", 3, 3);
    const auto s = arena.alloc<typename Q::template Span<typename Q::F32>>("s", 3);
    const auto x = arena.alloc<typename Q::template Span<typename Q::F32>>("x", 4);
    const auto y = arena.alloc<typename Q::template Span<typename Q::F32>>("y", 9);
    svd<Q>(place<Q>(arena, random.matrix(3, 3)), u, s, v, arena);
    least_squares<Q>(place<Q>(arena, random.matrix(6, 4)),
                     place_vector<Q>(arena, random.matrix(6, 1)), x);
    smallest_eigenvector<Q>(place<Q>(arena, random.positive_definite(9, 0.01)), y);
    std::vector<float> all = test::values(u.data());
    for (const auto& part :
         {test::values(v.data()), test::values(s), test::values(x), test::values(y)})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  });
}

}  // namespace
}  // namespace leviosim::vio::levio
