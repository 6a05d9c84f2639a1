#include "workload/math/svd.h"

#include "tests/support/dense_algebra.h"
#include "tests/workload/math_fixture.h"

namespace leviosim::vio::test {
namespace {

using P = work::Native;

struct Singular {
  Eigen::MatrixXd u, v;
  Eigen::VectorXd s;
};

Singular decompose(const Eigen::MatrixXd& m) {
  work::Arena arena("L1", Bytes(8192));
  const int n = static_cast<int>(m.rows());
  const auto a = place<P>(arena, m);
  const auto u = alloc_matrix<P>(arena, "u", n, n);
  const auto v = alloc_matrix<P>(arena, "v", n, n);
  const auto s = arena.alloc<P::Span<float>>("s", n);
  svd_square<P>(a, u, s, v, 500, 1e-8f, DiagonalPrecision::Single);
  return {to_eigen(u), to_eigen(v), to_eigen_vector(s)};
}

Singular decompose3(const Eigen::Matrix3d& m) {
  Mat3<P> u, v;
  Vec3<P> s;
  svd3<P>(to_mat3<P>(m), u, s, v);
  return {to_eigen(u), to_eigen(v), to_eigen(s)};
}

/// Holds for any rank: orthonormal factors that reproduce the matrix.
void expect_decomposes(const Singular& d, const Eigen::MatrixXd& m, double tolerance) {
  const auto n = m.rows();
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
  EXPECT_LT((d.u.transpose() * d.u - one).norm(), tolerance);
  EXPECT_LT((d.v.transpose() * d.v - one).norm(), tolerance);
  const Eigen::MatrixXd product = d.u * d.s.asDiagonal() * d.v.transpose();
  EXPECT_LE((product - m).norm(), tolerance * m.norm());
}

Eigen::Matrix3d rotation(Random& random) {
  const Eigen::Vector3d w = random.matrix(3, 1);
  return Eigen::AngleAxisd(3.0 * w.norm(), w.normalized()).toRotationMatrix();
}

TEST(Svd, AgreesWithEigenForRandomMatrices) {
  Random random(1);
  for (int n = 2; n <= 9; ++n)
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::MatrixXd m = random.matrix(n, n);
      const Singular d = decompose(m);
      const Eigen::VectorXd reference = tests::singular_values(m);
      EXPECT_LT((d.s - reference).norm(), 2e-4) << "size " << n;
      expect_decomposes(d, m, 2e-5);
    }
}

TEST(Svd, ThreeByThreeIsScaleFree) {
  Random random(2);
  for (const double scale : {1e-6, 1e-3, 1.0, 1e3, 1e6})
    for (int trial = 0; trial < 100; ++trial) {
      const Eigen::Matrix3d m = random.matrix(3, 3) * scale;
      const Singular d = decompose3(m);
      const Eigen::Vector3d reference = tests::singular_values(m);
      EXPECT_LT((d.s - reference).norm(), 1e-4 * scale);
      expect_decomposes(d, m, 1e-5);
    }
}

TEST(Svd, EssentialMatricesHaveTwoEqualSingularValues) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d t = Eigen::Vector3d(random.matrix(3, 1)).normalized();
    Eigen::Matrix3d cross;
    cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
    const Eigen::Matrix3d m = cross * rotation(random);
    const Singular d = decompose3(m);
    EXPECT_LT((d.s - Eigen::Vector3d(1, 1, 0)).norm(), 1e-5);
    EXPECT_NEAR(std::abs(d.u.col(2).dot(t)), 1.0, 1e-5);
    expect_decomposes(d, m, 1e-5);
  }
}

TEST(Svd, CompletesTheBasisOfRankOneAndOfZero) {
  Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Matrix3d m = random.matrix(3, 1) * random.matrix(1, 3);
    const Singular d = decompose3(m);
    EXPECT_LT(d.s(1) + d.s(2), 2e-6 * m.norm() + 1e-12);
    expect_decomposes(d, m, 1e-5);
  }
  const Singular zero = decompose3(Eigen::Matrix3d::Zero());
  EXPECT_EQ(zero.s.norm(), 0.0);
  expect_decomposes(zero, Eigen::Matrix3d::Zero(), 1e-6);
}

TEST(Svd, RotationsKeepUnitSingularValues) {
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Matrix3d R = rotation(random);
    const Singular d = decompose3(R);
    EXPECT_LT((d.s - Eigen::Vector3d::Ones()).norm(), 2e-6);
    expect_decomposes(d, R, 2e-6);
  }
}

TEST(Svd, BothPoliciesAndEveryCompilerComputeTheSameBits) {
  const std::vector<float> out = same_bits_with_both_policies([]<class Q>() {
    Random random(6);
    std::vector<float> all;
    for (int trial = 0; trial < 20; ++trial) {
      Mat3<Q> a = to_mat3<Q>(random.matrix(3, 3));
      for (int c = 0; c < 3 && trial % 4 == 3; ++c) a.m[2][c] = a.m[0][c];
      Mat3<Q> u, v;
      Vec3<Q> s;
      svd3<Q>(a, u, s, v);
      append(all, u);
      append(all, s);
      append(all, v);
    }
    return all;
  });
  EXPECT_EQ(fingerprint(out), 635739247253194450u);
}

}  // namespace
}  // namespace leviosim::vio::test
