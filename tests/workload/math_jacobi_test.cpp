#include "workload/math/jacobi.h"

#include <cmath>

#include "tests/support/dense_algebra.h"
#include "tests/workload/math_fixture.h"

namespace leviosim::vio::test {
namespace {

using P = work::Native;

double off_diagonal_norm2(const Eigen::MatrixXd& a) {
  return a.squaredNorm() - a.diagonal().squaredNorm();
}

struct Decomposition {
  Eigen::MatrixXd a;  ///< as left behind
  Eigen::MatrixXd v;
  int rotations;
};

template <class Q = P>
Decomposition decompose(const Eigen::MatrixXd& m, int max_rotations, float tolerance,
                        DiagonalPrecision precision = DiagonalPrecision::Single) {
  work::Arena arena("L1", Bytes(8192));
  const auto a = place<Q>(arena, m);
  const auto v = alloc_matrix<Q>(arena, "vectors", a.rows(), a.rows());
  const int rotations = jacobi_eigen_classical<Q>(a, v, max_rotations, tolerance, precision);
  return {to_eigen(a), to_eigen(v), rotations};
}

TEST(Jacobi, AgreesWithEigenForAllSizes) {
  Random random(1);
  for (const auto precision : {DiagonalPrecision::Single, DiagonalPrecision::Double})
    for (int n = 2; n <= 12; ++n)
      for (int trial = 0; trial < 10; ++trial) {
        const Eigen::MatrixXd m = random.symmetric(n);
        const Decomposition d = decompose(m, 1000, 1e-7f, precision);
        Eigen::VectorXd lambda = d.a.diagonal();
        std::sort(lambda.begin(), lambda.end());
        const Eigen::VectorXd reference = tests::symmetric_eigen(m).values;
        EXPECT_LT((lambda - reference).norm(), 2e-6 * n);
        EXPECT_LT((m * d.v - d.v * d.a.diagonal().asDiagonal()).norm(), 3e-6 * n);
        EXPECT_LT((d.v.transpose() * d.v - Eigen::MatrixXd::Identity(n, n)).norm(), 3e-6 * n);
        EXPECT_LT(d.rotations, 1000);
      }
}

TEST(Jacobi, TwoByTwoHasAClosedForm) {
  Eigen::MatrixXd m(2, 2);
  m << 5.0, 3.0, 3.0, 5.0;
  const Decomposition d = decompose(m, 10, 1e-6f);
  EXPECT_EQ(d.rotations, 1);
  EXPECT_NEAR(d.a.diagonal().maxCoeff(), 8.0, 2e-6);
  EXPECT_NEAR(d.a.diagonal().minCoeff(), 2.0, 2e-6);
}

TEST(Jacobi, EveryRotationRemovesTheLargestElement) {
  Random random(2);
  const Eigen::MatrixXd m = random.symmetric(7);
  Eigen::MatrixXd before = m;
  for (int rotations = 1; rotations < 12; ++rotations) {
    const Eigen::MatrixXd after = decompose(m, rotations, 0.0f).a;
    Eigen::MatrixXd off = before;
    off.diagonal().setZero();
    const double largest = off.cwiseAbs().maxCoeff();
    EXPECT_NEAR(off_diagonal_norm2(after), off_diagonal_norm2(before) - 2.0 * largest * largest,
                1e-5);
    EXPECT_EQ(after, after.transpose());
    before = after;
  }
}

TEST(Jacobi, LeavesDiagonalMatricesAloneAndStopsWhenTold) {
  Eigen::MatrixXd diagonal = Eigen::Vector3d(3.0, -1.0, 2.0).asDiagonal();
  EXPECT_EQ(decompose(diagonal, 10, 1e-8f).rotations, 0);
  EXPECT_EQ(decompose(diagonal, 10, 1e-8f).v, Eigen::MatrixXd::Identity(3, 3));
  diagonal(0, 2) = diagonal(2, 0) = 1e-3;
  EXPECT_EQ(decompose(diagonal, 10, 2e-3f).rotations, 0);
  EXPECT_EQ(decompose(diagonal, 10, 0.5e-3f).rotations, 1);
  Random random(3);
  EXPECT_EQ(decompose(random.symmetric(12), 17, 1e-8f).rotations, 17);
}

TEST(Jacobi, DoublePrecisionIsSpentOnTheDiagonalOnly) {
  Random random(4);
  const Eigen::MatrixXd m = random.symmetric(6);
  work::take_tally();
  const int rotations =
      decompose<work::Counting>(m, 20, 1e-9f, DiagonalPrecision::Double).rotations;
  const work::Counts with = work::take_tally();
  const auto n = static_cast<std::uint64_t>(rotations);
  EXPECT_EQ(with[work::Op::F64Mul], 6 * n);
  EXPECT_EQ(with[work::Op::F64Add], 4 * n);
  EXPECT_EQ(with[work::Op::F64Convert], 12 * n);

  decompose<work::Counting>(m, 20, 1e-9f, DiagonalPrecision::Single);
  const work::Counts without = work::take_tally();
  EXPECT_EQ(without[work::Op::F64Mul] + without[work::Op::F64Add], 0u);
}

TEST(Jacobi, SortsEigenvaluesWithTheirVectors) {
  Random random(5);
  for (int n = 2; n <= 12; ++n) {
    const Eigen::MatrixXd m = random.symmetric(n);
    work::Arena arena("L1", Bytes(8192));
    const auto a = place<P>(arena, m);
    const auto v = alloc_matrix<P>(arena, "vectors", n, n);
    jacobi_eigen_classical<P>(a, v, 1000, 1e-7f, DiagonalPrecision::Single);
    sort_eigen_descending<P>(a, v);
    const Eigen::VectorXd lambda = to_eigen(a).diagonal();
    EXPECT_TRUE(std::is_sorted(lambda.begin(), lambda.end(), std::greater<>()));
    EXPECT_LT((m * to_eigen(v) - to_eigen(v) * lambda.asDiagonal()).norm(), 3e-6 * n);
  }
}

TEST(Jacobi, BothPoliciesAndEveryCompilerComputeTheSameBits) {
  const std::vector<float> out = same_bits_with_both_policies([]<class Q>() {
    std::vector<float> all;
    for (const auto precision : {DiagonalPrecision::Single, DiagonalPrecision::Double}) {
      Random random(6);
      work::Arena arena("L1", Bytes(8192));
      const auto a = place<Q>(arena, random.symmetric(9));
      const auto v = alloc_matrix<Q>(arena, "vectors", 9, 9);
      jacobi_eigen_classical<Q>(a, v, 60, 1e-8f, precision);
      sort_eigen_descending<Q>(a, v);
      for (const float x : values(a.data())) all.push_back(x);
      for (const float x : values(v.data())) all.push_back(x);
    }
    return all;
  });
  EXPECT_EQ(fingerprint(out), 10848502777411002397u);
}

}  // namespace
}  // namespace leviosim::vio::test
