// Biases of the IMU, estimated apart from the poses: once per window, poses and velocities held
// fixed, one linear least-squares step for three unknowns per sensor (levio_parameters: "biases are
// estimated separately per window").
//
// Gyro: the rotation residuals of the window's intervals, weighted with the variance of each.
// Accelerometer: the velocity residuals, weighted with their variance and the uncertainty of
// gravity, from which a bias can hardly be told; off unless asked for.
// Both are held to the estimate before with a standard deviation of its own. The random walk of the
// parameter sheet alone would freeze them where they start, so the default is wider: about what one
// window of 1.6 s tells (gyro noise 0.02 / √1.6 s).
#pragma once

#include <cmath>

#include "workload/inertial/residual.h"
#include "workload/math/solve.h"

namespace leviosim::vio {

struct BiasOptions {
  bool gyro = true;
  bool accel = false;
  float gyro_stddev = 0.015f;  ///< by which a new estimate may leave the one before, rad/s
  float accel_stddev = 0.05f;  ///< m/s²

  /// Held as tightly as the random walk of the noise model over `seconds`.
  static BiasOptions random_walk(const ImuNoise& noise, float seconds) {
    BiasOptions options;
    options.gyro_stddev = noise.gyro_bias * std::sqrt(seconds);
    options.accel_stddev = noise.accel_bias * std::sqrt(seconds);
    return options;
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
    add_rows(accel_, by_accel, r.velocity,
             F(1.0f) / ((accel_variance_ + gravity_variance_ * dt) * dt));
  }

  /// The new estimate. A sensor that is not asked for, or not determined, keeps its bias.
  ImuBias<P> solve(const BiasOptions& options) const {
    const typename P::Function function("BiasEstimator::solve");
    ImuBias<P> result = bias_;
    if (options.gyro) result.gyro = result.gyro + step(gyro_, options.gyro_stddev);
    if (options.accel) result.accel = result.accel + step(accel_, options.accel_stddev);
    return result;
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
  static Vec3<P> step(const Normal& normal, float stddev) {
    const Mat3<P> H = add_diagonal<P>(normal.H, F(1.0f / (stddev * stddev)));
    Mat3<P> inverse;
    if (!invert_spd3<P>(H, inverse)) return {0.0f, 0.0f, 0.0f};
    return inverse * normal.b;
  }

  ImuBias<P> bias_;
  Vec3<P> gravity_;
  F gyro_variance_, accel_variance_, gravity_variance_;
  Normal gyro_, accel_;
};

}  // namespace leviosim::vio
