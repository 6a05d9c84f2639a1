#include "tests/workload/inertial/preintegration_double.h"
//
#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/dense_algebra.h"
#include "tests/workload/inertial/preintegration_motion.h"
#include "workload/math/solve.h"

namespace leviosim::vio::test {
namespace {

using Double = DoublePolicy;

/// ΔR, Δv, Δp by their definitions, from the closed form of the motion.
struct TrueDelta {
  Matrix3d R;
  Vector3d v, p;
};
TrueDelta true_delta(const Motion& motion, double begin, double end) {
  const Matrix3d Rt = Motion::rotation(begin).transpose();
  const double dt = end - begin;
  const Vector3d v0 = Motion::velocity(begin);
  return {Rt * Motion::rotation(end), Rt * (Motion::velocity(end) - v0 - motion.gravity * dt),
          Rt * (Motion::position(end) - Motion::position(begin) - v0 * dt -
                0.5 * motion.gravity * dt * dt)};
}

template <class P>
double worst_error(const ImuDelta<P>& delta, const TrueDelta& truth) {
  return std::max({log_of(truth.R.transpose() * to_eigen<P>(delta.R)).norm(),
                   (to_eigen<P>(delta.v) - truth.v).norm(),
                   (to_eigen<P>(delta.p) - truth.p).norm()});
}

TEST(Preintegration, FollowsASmoothMotionInFloat) {
  const Motion motion;
  const OwnedInterval<work::Native> interval;
  integrate<work::Native>(motion, 0.2, 0.7, 100, interval, ImuBias<work::Native>::zero());
  EXPECT_NEAR(interval.duration(), 0.5f, 1e-6f);
  EXPECT_LT(worst_error(interval.delta(), true_delta(motion, 0.2, 0.7)), 1e-4);
}

TEST(Preintegration, ErrorIsOfSecondOrderInTheStep) {
  const Motion motion;
  double error[2];
  for (int i = 0; i < 2; ++i) {
    const OwnedInterval<Double> interval;
    integrate<Double>(motion, 0.2, 0.7, i == 0 ? 50 : 100, interval, ImuBias<Double>::zero());
    error[i] = worst_error(interval.delta(), true_delta(motion, 0.2, 0.7));
  }
  EXPECT_NEAR(error[0] / error[1], 4.0, 0.3);
}

TEST(Preintegration, SubtractsItsBiases) {
  const Motion motion;
  const Vector3d gyro(0.02, -0.05, 0.08), accel(0.1, -0.2, 0.3);
  const OwnedInterval<Double> plain, biased;
  integrate<Double>(motion, 0.0, 0.5, 100, plain, ImuBias<Double>::zero());
  integrate<Double>(motion, 0.0, 0.5, 100, biased, {to_vec3<Double>(gyro), to_vec3<Double>(accel)},
                    gyro, accel);
  const ImuDelta<Double> expected = plain.delta();
  EXPECT_LT(worst_error(biased.delta(), {to_eigen<Double>(expected.R), to_eigen<Double>(expected.v),
                                         to_eigen<Double>(expected.p)}),
            1e-12);
}

/// Derivative of the motion by one component of one bias: by integrating anew, and as recorded.
TEST(Preintegration, BiasDerivativesMatchIntegratingAnew) {
  const Motion motion;
  const ImuBias<Double> at{{0.01, -0.02, 0.03}, {0.1, 0.2, -0.1}};
  const OwnedInterval<Double> interval;
  integrate<Double>(motion, 0.3, 0.7, 80, interval, at);
  const ImuDelta<Double> middle = interval.delta();
  const double h = 1e-5;
  for (int sensor = 0; sensor < 2; ++sensor)
    for (int axis = 0; axis < 3; ++axis) {
      ImuDelta<Double> moved[2];
      for (int side = 0; side < 2; ++side) {
        Vector3d gyro = to_eigen<Double>(at.gyro), accel = to_eigen<Double>(at.accel);
        (sensor == 0 ? gyro : accel)[axis] += side == 0 ? -h : h;
        const OwnedInterval<Double> other;
        integrate<Double>(motion, 0.3, 0.7, 80, other,
                          {to_vec3<Double>(gyro), to_vec3<Double>(accel)});
        moved[side] = other.delta();
      }
      const Matrix3d R = to_eigen<Double>(middle.R);
      const Vector3d by_rotation = (log_of(R.transpose() * to_eigen<Double>(moved[1].R)) -
                                    log_of(R.transpose() * to_eigen<Double>(moved[0].R))) /
                                   (2 * h);
      const Vector3d by_v = (to_eigen<Double>(moved[1].v) - to_eigen<Double>(moved[0].v)) / (2 * h);
      const Vector3d by_p = (to_eigen<Double>(moved[1].p) - to_eigen<Double>(moved[0].p)) / (2 * h);
      // The recorded ones leave out terms of the relative order of one step's angle.
      const Vector3d none = Vector3d::Zero();
      const auto column = [axis](const Mat3<Double>& m) {
        return to_eigen<Double>(m.column(axis));
      };
      EXPECT_LT((by_rotation - (sensor == 0 ? column(interval.rotation_by_gyro()) : none)).norm(),
                1e-6);
      EXPECT_LT(
          (by_v - column(sensor == 0 ? interval.velocity_by_gyro() : interval.velocity_by_accel()))
              .norm(),
          3e-5);
      EXPECT_LT(
          (by_p - column(sensor == 0 ? interval.position_by_gyro() : interval.position_by_accel()))
              .norm(),
          1e-5);
    }
}

TEST(Preintegration, CorrectionIsOfFirstOrder) {
  const Motion motion;
  const OwnedInterval<Double> at_zero, at_bias;
  integrate<Double>(motion, 0.0, 0.4, 80, at_zero, ImuBias<Double>::zero());
  const ImuBias<Double> bias{{0.01, -0.02, 0.015}, {0.05, -0.1, 0.08}};
  integrate<Double>(motion, 0.0, 0.4, 80, at_bias, bias);
  const ImuDelta<Double> exact = at_bias.delta();
  const TrueDelta truth{to_eigen<Double>(exact.R), to_eigen<Double>(exact.v),
                        to_eigen<Double>(exact.p)};
  const double uncorrected = worst_error(at_zero.delta(), truth);
  EXPECT_GT(uncorrected, 1e-2);
  EXPECT_LT(worst_error(at_zero.corrected(bias), truth), 2e-2 * uncorrected);
}

Eigen::MatrixXd full_covariance(const Preintegration<Double>& interval) {
  Eigen::MatrixXd S(9, 9);
  for (int r = 0; r < 9; ++r)
    for (int c = 0; c < 9; ++c)
      S(r, c) = r / 3 >= c / 3 ? interval.covariance()(r, c) : interval.covariance()(c, r);
  return S;
}

/// Error of the motion (rotation, velocity, position) that noisy samples give.
Eigen::VectorXd noisy_error(const Motion& motion, const ImuDelta<Double>& clean, int steps,
                            TestRandom& random) {
  const ImuNoise noise;
  const double dt = 0.005, root = std::sqrt(dt);
  const OwnedInterval<Double> interval;
  interval.reset(ImuBias<Double>::zero());
  const auto noisy = [&](double t) {
    const Vector3d gyro = random.normal3() * (static_cast<double>(noise.gyro) / root);
    const Vector3d accel = random.normal3() * (static_cast<double>(noise.accel) / root);
    return motion.sample<Double>(t, dt, gyro, accel);
  };
  ImuSample<Double> previous = noisy(0);
  for (int i = 0; i < steps; ++i) {
    const ImuSample<Double> current = noisy(dt * (i + 1));
    interval.integrate(previous, current, noise);
    previous = current;
  }
  const ImuDelta<Double> delta = interval.delta();
  Eigen::VectorXd error(9);
  error << log_of(to_eigen<Double>(clean.R).transpose() * to_eigen<Double>(delta.R)),
      to_eigen<Double>(delta.v) - to_eigen<Double>(clean.v),
      to_eigen<Double>(delta.p) - to_eigen<Double>(clean.p);
  return error;
}

TEST(Preintegration, CovarianceIsThatOfManyNoisyIntegrations) {
  const Motion motion;
  const int steps = 80, runs = 1500;
  const OwnedInterval<Double> clean;
  integrate<Double>(motion, 0.0, 0.005 * steps, steps, clean, ImuBias<Double>::zero());
  TestRandom random(1);
  Eigen::MatrixXd sampled = Eigen::MatrixXd::Zero(9, 9);
  for (int i = 0; i < runs; ++i) {
    const Eigen::VectorXd e = noisy_error(motion, clean.delta(), steps, random);
    sampled += e * e.transpose() / runs;
  }
  const Eigen::MatrixXd predicted = full_covariance(clean);
  // In coordinates in which the prediction is the identity, the sample must be near it:
  // the standard error of an entry is 1/√runs = 2.6 % (3.7 % on the diagonal).
  const Eigen::MatrixXd whiten = tests::inverse(tests::cholesky(predicted));
  const Eigen::MatrixXd ratio = whiten * sampled * whiten.transpose();
  EXPECT_LT((ratio - Eigen::MatrixXd::Identity(9, 9)).cwiseAbs().maxCoeff(), 0.13);
}

TEST(Preintegration, CovarianceIsPositiveDefiniteFromTheFirstSampleOn) {
  const Motion motion;
  for (const int steps : {1, 2, 10, 2000}) {
    const OwnedInterval<work::Native> interval;
    integrate<work::Native>(motion, 0, 0.005 * steps, steps, interval,
                            ImuBias<work::Native>::zero());
    EXPECT_TRUE(cholesky_factor<work::Native>(interval.covariance())) << steps << " samples";
  }
}

TEST(Preintegration, CountsWhatItComputesNatively) {
  const Motion motion;
  const OwnedInterval<work::Native> native;
  const OwnedInterval<work::Counting> counting;
  integrate<work::Native>(motion, 0, 0.2, 40, native, {{0.01f, 0.02f, 0.03f}, {0.1f, 0.0f, 0.2f}});
  work::take_tally();
  integrate<work::Counting>(motion, 0, 0.2, 40, counting,
                            {{0.01f, 0.02f, 0.03f}, {0.1f, 0.0f, 0.2f}});
  const work::Counts counts = work::take_tally();
  EXPECT_EQ(0, std::memcmp(native.record().data(), counting.record().data(),
                           sizeof(float) * Preintegration<work::Native>::kFloats));
  // The paper's 2.42 kcycles per sample leave room for no more than that many operations.
  std::uint64_t operations = 0;
  for (const std::uint64_t n : counts.n) operations += n;
  EXPECT_LT(operations / 40, 2420u);
  EXPECT_GT(operations / 40, 500u);
}

}  // namespace
}  // namespace leviosim::vio::test
