// A smooth motion known in closed form, sampled as an IMU would.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/workload/math/eigen_conversions.h"
#include "workload/inertial/residual.h"

namespace leviosim::vio::test {

using Eigen::Matrix3d;
using Eigen::Vector3d;

inline Matrix3d exp_of(const Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-300) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}
inline Vector3d log_of(const Matrix3d& R) {
  const Eigen::AngleAxisd a(R);
  return a.angle() * a.axis();
}

/// SplitMix64, and normal variates by the polar method.
class TestRandom {
 public:
  explicit TestRandom(std::uint64_t seed) : state_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1.0p-53;
  }
  double normal() {
    double x, y, s;
    do {
      x = uniform(-1, 1);
      y = uniform(-1, 1);
      s = x * x + y * y;
    } while (s >= 1 || s == 0);
    return x * std::sqrt(-2 * std::log(s) / s);
  }
  Vector3d normal3() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }

 private:
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

/// Camera on a smooth path; the world's y axis points down.
struct Motion {
  Vector3d gravity{0, 9.81, 0};

  static Vector3d position(double t) {
    return {0.6 * std::sin(1.3 * t), 0.4 * std::sin(1.7 * t + 0.5), 0.3 * std::sin(0.9 * t + 1)};
  }
  static Vector3d velocity(double t) {
    return {0.6 * 1.3 * std::cos(1.3 * t), 0.4 * 1.7 * std::cos(1.7 * t + 0.5),
            0.3 * 0.9 * std::cos(0.9 * t + 1)};
  }
  static Vector3d acceleration(double t) {
    return {-0.6 * 1.3 * 1.3 * std::sin(1.3 * t), -0.4 * 1.7 * 1.7 * std::sin(1.7 * t + 0.5),
            -0.3 * 0.9 * 0.9 * std::sin(0.9 * t + 1)};
  }
  /// R_world_camera
  static Matrix3d rotation(double t) {
    return exp_of({0, 0.3 * std::sin(1.1 * t), 0}) * exp_of({0.2 * std::sin(0.8 * t + 0.3), 0, 0}) *
           exp_of({0, 0, 0.25 * std::sin(1.9 * t)});
  }
  /// Angular rate in the camera frame.
  static Vector3d rate(double t) {
    const double h = 1e-4;
    return log_of(rotation(t - h).transpose() * rotation(t + h)) / (2 * h);
  }
  Vector3d specific_force(double t) const {
    return rotation(t).transpose() * (acceleration(t) - gravity);
  }

  template <class P>
  ImuSample<P> sample(double t, double dt, const Vector3d& gyro_bias = Vector3d::Zero(),
                      const Vector3d& accel_bias = Vector3d::Zero()) const {
    return {static_cast<Plain<P>>(dt), to_vec3<P>(rate(t) + gyro_bias),
            to_vec3<P>(specific_force(t) + accel_bias)};
  }
  template <class P>
  KeyframeState<P> state(double t) const {
    return {{to_mat3<P>(rotation(t)), to_vec3<P>(position(t))}, to_vec3<P>(velocity(t))};
  }
};

/// A record of its own.
template <class P>
class OwnedInterval : public Preintegration<P> {
 public:
  using F = typename P::F32;
  OwnedInterval() : OwnedInterval(std::vector<F>(Preintegration<P>::kFloats)) {}
  OwnedInterval(const OwnedInterval&) = delete;
  OwnedInterval& operator=(const OwnedInterval&) = delete;

 private:
  explicit OwnedInterval(std::vector<F> memory)
      : Preintegration<P>({memory.data(), Preintegration<P>::kFloats}),
        memory_(std::move(memory)) {}
  std::vector<F> memory_;
};

/// Integrates `motion` over [begin, end] in `steps` equal steps.
template <class P>
void integrate(const Motion& motion, double begin, double end, int steps,
               const Preintegration<P>& interval, const ImuBias<P>& subtracted,
               const Vector3d& gyro_bias = Vector3d::Zero(),
               const Vector3d& accel_bias = Vector3d::Zero()) {
  interval.reset(subtracted);
  const double dt = (end - begin) / steps;
  for (int i = 0; i < steps; ++i)
    interval.integrate(motion.sample<P>(begin + i * dt, dt, gyro_bias, accel_bias),
                       motion.sample<P>(begin + (i + 1) * dt, dt, gyro_bias, accel_bias),
                       ImuNoise{});
}

}  // namespace leviosim::vio::test
