#include "workload/math/trig.h"
#include "workload/math/rotations.h"

#include <cmath>

#include "tests/workload/math/math_fixture.h"

namespace leviosim::vio::test {
namespace {

using P = work::Native;
constexpr double kPi = 3.14159265358979323846;

Eigen::Matrix3d exact_exp(const Eigen::Vector3d& w) {
  if (w.norm() == 0.0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
}
Eigen::Vector3d exact_log(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd a(R);
  return a.angle() * a.axis();
}
Eigen::Vector3d direction(Random& random) {
  Eigen::Vector3d d;
  do d = random.matrix(3, 1);
  while (d.norm() < 0.1);
  return d.normalized();
}

TEST(Trig, SineAndCosineAreAccurateOverManyTurns) {
  Random random(1);
  double worst = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const auto x = static_cast<float>(random.uniform(-1.0, 1.0) * (i % 2 == 0 ? 8.0 : 8192.0));
    worst = std::max(worst, std::abs(sin_of<P>(x) - std::sin(static_cast<double>(x))));
    worst = std::max(worst, std::abs(cos_of<P>(x) - std::cos(static_cast<double>(x))));
  }
  EXPECT_LT(worst, 1.5e-7);
}

TEST(Trig, SmallAnglesKeepTheirRelativeAccuracy) {
  for (float x = 1e-30f; x < 0.7f; x *= 1.7f) {
    const double exact_sine = std::sin(static_cast<double>(x));
    const double exact_angle = std::atan(static_cast<double>(x));
    EXPECT_LT(std::abs(sin_of<P>(x) - exact_sine), 2e-7 * exact_sine);
    EXPECT_LT(std::abs(atan2_of<P>(x, 1.0f) - exact_angle), 2e-7 * exact_angle);
  }
}

TEST(Trig, ExactValues) {
  EXPECT_EQ(sin_of<P>(0.0f), 0.0f);
  EXPECT_EQ(cos_of<P>(0.0f), 1.0f);
  EXPECT_EQ(atan2_of<P>(0.0f, 0.0f), 0.0f);
  EXPECT_EQ(atan2_of<P>(0.0f, 3.0f), 0.0f);
  EXPECT_EQ(atan2_of<P>(0.0f, -3.0f), trig::kPi);
  EXPECT_EQ(atan2_of<P>(2.0f, 0.0f), trig::kHalfPi);
  EXPECT_EQ(atan2_of<P>(-2.0f, 0.0f), -trig::kHalfPi);
}

TEST(Trig, OneCallForBothGivesTheSameBits) {
  for (int i = -3000; i < 3000; ++i) {
    const float x = static_cast<float>(i) * 0.013f;
    const SinCos<P> both = sincos_of<P>(x);
    EXPECT_EQ(both.sin, sin_of<P>(x));
    EXPECT_EQ(both.cos, cos_of<P>(x));
  }
}

TEST(Trig, ArcTangentIsAccurateInAllQuadrantsAndScales) {
  Random random(2);
  double worst = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const double scale = std::exp(random.uniform(-30.0, 30.0));
    const double angle = random.uniform(-kPi, kPi);
    const auto y = static_cast<float>(scale * std::sin(angle));
    const auto x = static_cast<float>(scale * std::cos(angle));
    worst = std::max(worst, std::abs(atan2_of<P>(y, x) - std::atan2(double(y), double(x))));
  }
  EXPECT_LT(worst, 4e-7);
}

TEST(So3, ExpIsTheRotationAboutTheVector) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const double angle = i % 2 == 0 ? random.uniform(0.0, 6.0) : std::pow(10.0, -(i % 17));
    const Vec3<P> w = to_vec3<P>(direction(random) * angle);
    EXPECT_LT((to_eigen(so3_exp<P>(w)) - exact_exp(to_eigen(w))).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(So3, LogInvertsExpBelowHalfATurn) {
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const double angle = i % 2 == 0 ? random.uniform(0.0, 3.1) : std::pow(10.0, -(i % 8));
    const Vec3<P> w = to_vec3<P>(direction(random) * angle);
    const double error = (to_eigen(so3_log<P>(so3_exp<P>(w))) - to_eigen(w)).norm();
    EXPECT_LT(error, 2e-6) << "angle " << angle;
  }
}

TEST(So3, ExpInvertsLogUpToHalfATurn) {
  Random random(5);
  for (const double angle : {0.0, 1e-4, 3.0, 3.1, 3.14, 3.1415, kPi - 1e-6, kPi}) {
    for (int i = 0; i < 200; ++i) {
      const Mat3<P> R = to_mat3<P>(exact_exp(direction(random) * angle));
      const Vec3<P> w = so3_log<P>(R);
      EXPECT_LT((to_eigen(so3_exp<P>(w)) - to_eigen(R)).cwiseAbs().maxCoeff(), 2e-6) << angle;
      EXPECT_LT(norm(w), static_cast<float>(kPi) + 1e-6f);
    }
  }
  const Mat3<P> half_turn{{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
  EXPECT_NEAR(std::abs(so3_log<P>(half_turn).x), kPi, 1e-6);
  EXPECT_EQ(norm(so3_log<P>(Mat3<P>::identity())), 0.0f);
}

TEST(So3, RightJacobianIsTheDerivativeOfExp) {
  Random random(6);
  for (int i = 0; i < 500; ++i) {
    const double angle = i % 2 == 0 ? random.uniform(0.0, 5.0) : std::pow(10.0, -(i % 7));
    const Vec3<P> w = to_vec3<P>(direction(random) * angle);
    const Eigen::Matrix3d R = exact_exp(to_eigen(w));
    constexpr double kStep = 1e-5;
    Eigen::Matrix3d numerical;
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d step = Eigen::Vector3d::Unit(c) * kStep;
      numerical.col(c) = (exact_log(R.transpose() * exact_exp(to_eigen(w) + step)) -
                          exact_log(R.transpose() * exact_exp(to_eigen(w) - step))) /
                         (2.0 * kStep);
    }
    const Eigen::Matrix3d error = to_eigen(so3_right_jacobian<P>(w)) - numerical;
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 2e-6) << "angle " << angle;
  }
}

TEST(So3, RightJacobianTimesItsInverseIsOne) {
  Random random(7);
  for (int i = 0; i < 1000; ++i) {
    const double angle = i % 2 == 0 ? random.uniform(0.0, 5.0) : std::pow(10.0, -(i % 7));
    const Vec3<P> w = to_vec3<P>(direction(random) * angle);
    const Mat3<P> product = so3_right_jacobian<P>(w) * so3_right_jacobian_inverse<P>(w);
    const Eigen::Matrix3d error = to_eigen(product) - Eigen::Matrix3d::Identity();
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 5e-6) << "angle " << angle;
  }
}

TEST(Trig, BothPoliciesAndEveryCompilerComputeTheSameBits) {
  const std::vector<float> out = same_bits_with_both_policies([]<class Q>() {
    std::vector<float> v;
    for (int i = -400; i < 400; ++i) {
      const float x = static_cast<float>(i) * 0.0173f;
      v.push_back(work::value(sin_of<Q>(x)));
      v.push_back(work::value(cos_of<Q>(x)));
      v.push_back(work::value(atan2_of<Q>(x, 0.7f - x)));
      const Vec3<Q> w{x, 0.3f * x, 0.1f - x};
      append(v, so3_exp<Q>(w));
      append(v, so3_log<Q>(so3_exp<Q>(w)));
      append(v, so3_right_jacobian<Q>(w));
      append(v, so3_right_jacobian_inverse<Q>(w));
    }
    return v;
  });
  EXPECT_EQ(fingerprint(out), 136886228723515891u);
}

}  // namespace
}  // namespace leviosim::vio::test
