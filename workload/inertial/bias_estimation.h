// Biases of the IMU, estimated apart from the poses: once per window, poses and velocities held
// fixed, one linear least-squares step for three unknowns per sensor (PARAMETERS.md#optimiser).
//
// Gyro: the rotation residuals of the window's intervals, weighted with the variance of each.
// Accelerometer: the velocity residuals, weighted with their variance and the uncertainty of
// gravity, from which a bias is hardly observable; off unless asked for.
// Both are held to a prior: what the intervals that have left the window said, each once. Its
// information grows by theirs, and the random walk between them takes some away. A window is
// estimated again after every frame, and so the prior must not be the estimate before: the same
// intervals would then be counted with every frame, and a single bad rotation among them would pull
// the bias after it without bound.
//
// Before the first interval nothing is known but how large such biases are: 0.1 rad/s is a wide
// bound for the zero-rate level of MEMS gyroscopes (some °/s), 0.05 m/s² that of accelerometers.
#pragma once

#include "workload/inertial/record_sums.h"
#include "workload/inertial/residual.h"
#include "workload/math/solve.h"

namespace leviosim::vio {

struct BiasOptions {
  bool gyro = true;
  bool accel = false;
  float gyro_stddev = 0.1f;    ///< before anything is known, rad/s
  float accel_stddev = 0.05f;  ///< m/s²
};

/// What is known of the biases apart from the window.
template <class P>
struct BiasPrior {
  using F = typename P::F32;

  ImuBias<P> mean;
  F gyro_information;   ///< 1/variance of each component, s²/rad²
  F accel_information;  ///< s⁴/m²

  static BiasPrior unknown(const BiasOptions& options) {
    return {ImuBias<P>::zero(), 1.0f / (options.gyro_stddev * options.gyro_stddev),
            1.0f / (options.accel_stddev * options.accel_stddev)};
  }
};

/// Collects the normal equations of both estimates.
template <class P>
class BiasEstimator {
 public:
  using F = typename P::F32;

  /// @param bias     the estimate so far
  /// @param gravity  in the world frame, m/s²
  BiasEstimator(const ImuBias<P>& bias, const Vec3<P>& gravity, const ImuNoise& noise)
      : bias_(bias),
        gravity_(gravity),
        gyro_variance_(noise.gyro * noise.gyro),
        accel_variance_(noise.accel * noise.accel),
        gravity_variance_(noise.gravity * noise.gravity) {}

  /// Adds an interval between two keyframes; intervals of no length say nothing.
  void add(const Preintegration<P>& interval, const KeyframeState<P>& begin,
           const KeyframeState<P>& end) {
    const typename P::Function function("BiasEstimator::add");
    const F dt = interval.duration();
    if (!(dt > 0.0f)) return;
    const ImuResidual<P> r = imu_residual<P>(begin, end, interval.corrected(bias_), gravity_);
    add_rows(gyro_, rotation_residual_by_gyro_bias<P>(interval, bias_, r), r.rotation,
             F(1.0f) / (gyro_variance_ * dt));
    const Mat3<P> by_accel = scaled<P>(F(-1.0f), interval.velocity_by_accel());
    const F accel_variance = accel_variance_ + gravity_variance_ * dt;
    add_rows(accel_, by_accel, r.velocity, F(1.0f) / (accel_variance * dt));
    // Derivatives of both residuals are dt times a rotation, to first order.
    added_gyro_ += dt / gyro_variance_;
    added_accel_ += dt / accel_variance;
    added_time_ += dt;
  }

  /// The new estimate. A sensor that is not asked for, or not determined, keeps its bias.
  ImuBias<P> solve(const BiasOptions& options, const BiasPrior<P>& prior) const {
    const typename P::Function function("BiasEstimator::solve");
    ImuBias<P> result = bias_;
    if (options.gyro)
      result.gyro = estimate(gyro_, bias_.gyro, prior.mean.gyro, prior.gyro_information);
    if (options.accel)
      result.accel = estimate(accel_, bias_.accel, prior.mean.accel, prior.accel_information);
    return result;
  }

  /// The prior that is left when what was added is forgotten.
  BiasPrior<P> absorb(const BiasOptions& options, const BiasPrior<P>& prior,
                      const ImuNoise& noise) const {
    return {solve(options, prior),
            after_walk(prior.gyro_information + added_gyro_, noise.gyro_bias),
            after_walk(prior.accel_information + added_accel_, noise.accel_bias)};
  }

 private:
  struct Normal {
    Mat3<P> H = Mat3<P>::zero();
    Vec3<P> b{0.0f, 0.0f, 0.0f};
  };

  static void add_rows(Normal& normal, const Mat3<P>& J, const Vec3<P>& residual, F weight) {
    const Mat3<P> weighted = scaled<P>(weight, transpose(J));
    normal.H = normal.H + weighted * J;
    normal.b = normal.b - weighted * residual;
  }
  /// @param bias  at which the residuals were taken
  static Vec3<P> estimate(const Normal& normal, const Vec3<P>& bias, const Vec3<P>& mean,
                          F information) {
    Mat3<P> inverse;
    if (!invert_spd3<P>(add_diagonal<P>(normal.H, information), inverse)) return bias;
    return bias + inverse * (normal.b + (mean - bias) * information);
  }
  F after_walk(F information, float walk) const {
    return information / (F(1.0f) + information * F(walk * walk) * added_time_);
  }

  ImuBias<P> bias_;
  Vec3<P> gravity_;
  F gyro_variance_, accel_variance_, gravity_variance_;
  Normal gyro_, accel_;
  F added_gyro_ = 0.0f, added_accel_ = 0.0f;  ///< information
  F added_time_ = 0.0f;                       ///< s
};

}  // namespace leviosim::vio
