#include "tests/workload/inertial/preintegration_double.h"
//
#include <gtest/gtest.h>

#include <functional>

#include "tests/workload/inertial/preintegration_motion.h"
#include "workload/inertial/bias_estimation.h"

namespace leviosim::vio::test {
namespace {

using Double = DoublePolicy;
using State = KeyframeState<Double>;

/// An interval and two states that it does not quite fit.
struct Fixture {
  Fixture() {
    integrate<Double>(motion, 0.3, 0.6, 60, interval, subtracted);
    begin.T_world_camera.R = to_mat3<Double>(Motion::rotation(0.3) * exp_of({0.02, -0.03, 0.05}));
    end.velocity = end.velocity + to_vec3<Double>({0.1, -0.2, 0.05});
    end.T_world_camera.t = end.T_world_camera.t + to_vec3<Double>({0.03, 0.02, -0.05});
  }
  ImuResidual<Double> residual() const { return residual(begin, end, bias, gravity); }
  ImuResidual<Double> residual(const State& b, const State& e, const ImuBias<Double>& at,
                               const Vec3<Double>& g) const {
    return imu_residual<Double>(b, e, interval.corrected(at), g);
  }

  Motion motion;
  OwnedInterval<Double> interval;
  ImuBias<Double> subtracted{{0.01, 0.02, -0.01}, {0.1, -0.1, 0.2}};
  ImuBias<Double> bias{{0.03, -0.01, 0.02}, {0.15, 0.1, -0.05}};
  Vec3<Double> gravity = to_vec3<Double>(motion.gravity);
  State begin = motion.state<Double>(0.3), end = motion.state<Double>(0.6);
};

Eigen::VectorXd stacked(const ImuResidual<Double>& r) {
  Eigen::VectorXd v(9);
  v << to_eigen<Double>(r.rotation), to_eigen<Double>(r.velocity), to_eigen<Double>(r.position);
  return v;
}

/// Central differences of f at 0 in three directions: 9×3.
Eigen::MatrixXd differences(const std::function<ImuResidual<Double>(const Vector3d&)>& f) {
  const double h = 1e-5;
  Eigen::MatrixXd J(9, 3);
  for (int i = 0; i < 3; ++i) {
    const Vector3d step = h * Vector3d::Unit(i);
    J.col(i) = (stacked(f(step)) - stacked(f(-step))) / (2 * h);
  }
  return J;
}

Eigen::MatrixXd rows(const Matrix3d& rotation, const Matrix3d& velocity, const Matrix3d& position) {
  Eigen::MatrixXd J(9, 3);
  J << rotation, velocity, position;
  return J;
}

State turned(State s, const Vector3d& w) {
  s.T_world_camera.R = to_mat3<Double>(to_eigen<Double>(s.T_world_camera.R) * exp_of(w));
  return s;
}
State moved(State s, const Vector3d& d) {
  s.T_world_camera.t = s.T_world_camera.t + to_vec3<Double>(d);
  return s;
}
State faster(State s, const Vector3d& d) {
  s.velocity = s.velocity + to_vec3<Double>(d);
  return s;
}

constexpr double kTolerance = 2e-8;

TEST(ImuResidual, VanishesForStatesThatFitTheInterval) {
  Fixture f;
  const ImuDelta<Double> d = f.interval.corrected(f.bias);
  const Matrix3d R = to_eigen<Double>(f.begin.T_world_camera.R);
  const Vector3d v = to_eigen<Double>(f.begin.velocity), g = f.motion.gravity;
  f.end.T_world_camera.R = f.begin.T_world_camera.R * d.R;
  f.end.velocity = to_vec3<Double>(v + g * d.dt + R * to_eigen<Double>(d.v));
  f.end.T_world_camera.t = to_vec3<Double>(to_eigen<Double>(f.begin.T_world_camera.t) + v * d.dt +
                                           0.5 * g * d.dt * d.dt + R * to_eigen<Double>(d.p));
  EXPECT_LT(stacked(f.residual()).norm(), 1e-12);
}

TEST(ImuResidual, DerivativesByTheStateAtTheBegin) {
  const Fixture f;
  const ImuResidual<Double> r = f.residual();
  const ImuJacobians<Double> J =
      imu_jacobians<Double>(f.begin, f.end, f.interval.duration(), f.gravity, r);
  const Matrix3d zero = Matrix3d::Zero(), Rt = to_eigen<Double>(J.Rt);
  const double dt = f.interval.duration();
  const auto with = [&](const State& s) { return f.residual(s, f.end, f.bias, f.gravity); };
  EXPECT_LT(
      (differences([&](const Vector3d& w) { return with(turned(f.begin, w)); }) -
       rows(to_eigen<Double>(J.rotation_by_rotation0), to_eigen<Double>(J.velocity_by_rotation0),
            to_eigen<Double>(J.position_by_rotation0)))
          .norm(),
      kTolerance);
  EXPECT_LT((differences([&](const Vector3d& d) { return with(moved(f.begin, d)); }) -
             rows(zero, zero, -Rt))
                .norm(),
            kTolerance);
  EXPECT_LT((differences([&](const Vector3d& d) { return with(faster(f.begin, d)); }) -
             rows(zero, -Rt, -dt * Rt))
                .norm(),
            kTolerance);
}

TEST(ImuResidual, DerivativesByTheStateAtTheEnd) {
  const Fixture f;
  const ImuResidual<Double> r = f.residual();
  const ImuJacobians<Double> J =
      imu_jacobians<Double>(f.begin, f.end, f.interval.duration(), f.gravity, r);
  const Matrix3d zero = Matrix3d::Zero(), Rt = to_eigen<Double>(J.Rt);
  const auto with = [&](const State& s) { return f.residual(f.begin, s, f.bias, f.gravity); };
  EXPECT_LT((differences([&](const Vector3d& w) { return with(turned(f.end, w)); }) -
             rows(to_eigen<Double>(J.rotation_by_rotation1), zero, zero))
                .norm(),
            kTolerance);
  EXPECT_LT(
      (differences([&](const Vector3d& d) { return with(moved(f.end, d)); }) - rows(zero, zero, Rt))
          .norm(),
      kTolerance);
  EXPECT_LT((differences([&](const Vector3d& d) { return with(faster(f.end, d)); }) -
             rows(zero, Rt, zero))
                .norm(),
            kTolerance);
}

TEST(ImuResidual, DerivativesByBiasesAndGravity) {
  const Fixture f;
  const double dt = f.interval.duration();
  const Matrix3d Rt = to_eigen<Double>(f.begin.T_world_camera.R).transpose();
  const auto with_bias = [&](const Vector3d& gyro, const Vector3d& accel) {
    const ImuBias<Double> at{f.bias.gyro + to_vec3<Double>(gyro),
                             f.bias.accel + to_vec3<Double>(accel)};
    return f.residual(f.begin, f.end, at, f.gravity);
  };
  const Vector3d none = Vector3d::Zero();
  const Matrix3d by_gyro =
      to_eigen<Double>(rotation_residual_by_gyro_bias<Double>(f.interval, f.bias, f.residual()));
  EXPECT_LT((differences([&](const Vector3d& d) { return with_bias(d, none); }) -
             rows(by_gyro, -to_eigen<Double>(f.interval.velocity_by_gyro()),
                  -to_eigen<Double>(f.interval.position_by_gyro())))
                .norm(),
            kTolerance);
  EXPECT_LT((differences([&](const Vector3d& d) { return with_bias(none, d); }) -
             rows(Matrix3d::Zero(), -to_eigen<Double>(f.interval.velocity_by_accel()),
                  -to_eigen<Double>(f.interval.position_by_accel())))
                .norm(),
            kTolerance);
  EXPECT_LT((differences([&](const Vector3d& d) {
               return f.residual(f.begin, f.end, f.bias, f.gravity + to_vec3<Double>(d));
             }) -
             rows(Matrix3d::Zero(), -dt * Rt, -0.5 * dt * dt * Rt))
                .norm(),
            kTolerance);
}

/// Feeds `intervals` true keyframe pairs whose samples carry the given biases.
template <class P>
ImuBias<P> estimated(const Vector3d& gyro, const Vector3d& accel, const BiasOptions& options,
                     int intervals = 7) {
  const Motion motion;
  BiasEstimator<P> estimator(ImuBias<P>::zero(), to_vec3<P>(motion.gravity), ImuNoise{});
  for (int k = 0; k < intervals; ++k) {
    const OwnedInterval<P> interval;
    integrate<P>(motion, 0.2 * k, 0.2 * (k + 1), 40, interval, ImuBias<P>::zero(), gyro, accel);
    estimator.add(interval, motion.state<P>(0.2 * k), motion.state<P>(0.2 * (k + 1)));
  }
  return estimator.solve(options, BiasPrior<P>::unknown(options));
}

TEST(BiasEstimator, FindsTheGyroBiasOfTrueMotion) {
  const Vector3d gyro(0.02, -0.03, 0.08);
  BiasOptions free;
  free.gyro_stddev = 10;
  const ImuBias<work::Native> bias = estimated<work::Native>(gyro, Vector3d::Zero(), free);
  EXPECT_LT((to_eigen<work::Native>(bias.gyro) - gyro).norm(), 1e-3);
  EXPECT_EQ(bias.accel.x, 0.0f);
}

TEST(BiasEstimator, PriorHoldsTheEstimateBack) {
  const Vector3d gyro(0, 0, 0.08);
  BiasOptions options;
  options.gyro_stddev = 0.02f / std::sqrt(1.4f);  // what 7 intervals of 0.2 s tell: meets half-way
  const Vector3d half =
      to_eigen<work::Native>(estimated<work::Native>(gyro, Vector3d::Zero(), options).gyro);
  EXPECT_NEAR(half.z(), 0.04, 1e-3);
  options.gyro_stddev = 1e-6f;
  const Vector3d held =
      to_eigen<work::Native>(estimated<work::Native>(gyro, Vector3d::Zero(), options).gyro);
  EXPECT_LT(held.norm(), 1e-6);
}

/// An estimator around `bias` that has seen one interval of 0.2 s whose samples carry `gyro`.
BiasEstimator<work::Native> after_one_interval(const ImuBias<work::Native>& bias,
                                               const Vector3d& gyro) {
  const Motion motion;
  const OwnedInterval<work::Native> interval;
  integrate<work::Native>(motion, 0, 0.2, 40, interval, ImuBias<work::Native>::zero(), gyro);
  BiasEstimator<work::Native> estimator(bias, to_vec3<work::Native>(motion.gravity), ImuNoise{});
  estimator.add(interval, motion.state<work::Native>(0), motion.state<work::Native>(0.2));
  return estimator;
}

TEST(BiasEstimator, EstimatingAgainFromTheSameIntervalChangesNothing) {
  BiasOptions options;
  options.gyro_stddev = 0.02f / std::sqrt(0.2f);  // meets half-way
  const auto prior = BiasPrior<work::Native>::unknown(options);
  ImuBias<work::Native> bias = ImuBias<work::Native>::zero();
  for (int i = 0; i < 20; ++i) {
    bias = after_one_interval(bias, {0, 0, 0.08}).solve(options, prior);
    EXPECT_NEAR(bias.gyro.z, 0.04, 1e-3) << "estimate " << i;
  }
}

TEST(BiasEstimator, ForgottenIntervalsStayInThePrior) {
  BiasOptions options;
  options.gyro_stddev = 0.02f / std::sqrt(0.2f);
  const auto unknown = BiasPrior<work::Native>::unknown(options);
  const auto zero = ImuBias<work::Native>::zero();
  const auto prior = after_one_interval(zero, {0, 0, 0.08}).absorb(options, unknown, ImuNoise{});
  EXPECT_NEAR(prior.mean.gyro.z, 0.04, 1e-3);
  EXPECT_NEAR(prior.gyro_information, 2 * unknown.gyro_information, 0.1f);
  // A second interval that says the same counts half as much as what is known by now.
  const auto later = after_one_interval(zero, {0, 0, 0.08}).solve(options, prior);
  EXPECT_NEAR(later.gyro.z, 0.04 + 0.04 / 3, 1e-3);
}

TEST(BiasEstimator, TheRandomWalkTakesInformationAway) {
  BiasOptions options;
  ImuNoise restless;
  restless.gyro_bias = 1;  // 0.2 rad²/s² in 0.2 s: what was known is worth 1/0.2 at most
  const auto prior = after_one_interval(ImuBias<work::Native>::zero(), {0, 0, 0})
                         .absorb(options, BiasPrior<work::Native>::unknown(options), restless);
  EXPECT_LT(prior.gyro_information, 5.0f);
  EXPECT_GT(prior.gyro_information, 4.9f);
}

TEST(BiasEstimator, FindsTheAccelerometerBiasIfAsked) {
  const Vector3d accel(0.2, -0.1, 0.15);
  BiasOptions free;
  free.gyro = false;
  free.accel = true;
  free.accel_stddev = 1e3f;
  const ImuBias<work::Native> bias = estimated<work::Native>(Vector3d::Zero(), accel, free);
  EXPECT_LT((to_eigen<work::Native>(bias.accel) - accel).norm(), 5e-3);
  EXPECT_EQ(bias.gyro.x, 0.0f);
}

TEST(BiasEstimator, KeepsTheBiasWithoutIntervals) {
  const Motion motion;
  const ImuBias<work::Native> before{{0.1f, 0.2f, 0.3f}, {0.0f, 0.0f, 0.0f}};
  BiasEstimator<work::Native> estimator(before, to_vec3<work::Native>(motion.gravity), ImuNoise{});
  const OwnedInterval<work::Native> empty;
  empty.reset(before);
  estimator.add(empty, motion.state<work::Native>(0), motion.state<work::Native>(0.2));
  EXPECT_EQ(estimator.solve({}, {before, 0.0f, 0.0f}).gyro.y, 0.2f);
}

TEST(BiasEstimator, CountsWhatItComputesNatively) {
  BiasOptions both;
  both.accel = true;
  const Vector3d gyro(0.02, -0.03, 0.08), accel(0.2, -0.1, 0.15);
  const ImuBias<work::Native> native = estimated<work::Native>(gyro, accel, both);
  const ImuBias<work::Counting> counting = estimated<work::Counting>(gyro, accel, both);
  EXPECT_EQ(native.gyro.x, counting.gyro.x.v);
  EXPECT_EQ(native.gyro.z, counting.gyro.z.v);
  EXPECT_EQ(native.accel.y, counting.accel.y.v);
}

}  // namespace
}  // namespace leviosim::vio::test
