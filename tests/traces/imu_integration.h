// Integration of ideal IMU readings, to see whether they lead along the path they were made for.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>

#include "traces/synthesis/imu_synthesis.h"

namespace leviosim::traces::testing {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// World frame.
struct InertialState {
  Vector3d p, v;
  Eigen::Vector4d q;  // x y z w
};

inline InertialState slope(const InertialState& s, const ImuSample& sample) {
  const Quaterniond q(s.q);
  const Quaterniond spin(0, sample.gyro.x(), sample.gyro.y(), sample.gyro.z());
  return {s.v, q.normalized() * sample.accel + Vector3d(0, 0, -kGravity),
          0.5 * (q * spin).coeffs()};
}

inline InertialState step(const InertialState& s, const InertialState& d, double h) {
  return {s.p + h * d.p, s.v + h * d.v, s.q + h * d.q};
}

/// Runge-Kutta of fourth order over pairs of samples.
inline InertialState integrate(const ImuTrack& track) {
  const GroundTruthPose& start = track.truth.front();
  InertialState s{start.T_world_body.translation(), start.velocity,
                  Quaterniond(start.T_world_body.linear()).coeffs()};
  for (std::size_t i = 0; i + 2 < track.samples.size(); i += 2) {
    const ImuSample& middle = track.samples[i + 1];
    const double h = static_cast<double>(track.samples[i + 2].t_ns - track.samples[i].t_ns) * 1e-9;
    const InertialState k1 = slope(s, track.samples[i]);
    const InertialState k2 = slope(step(s, k1, h / 2), middle);
    const InertialState k3 = slope(step(s, k2, h / 2), middle);
    const InertialState k4 = slope(step(s, k3, h), track.samples[i + 2]);
    s = step(s, k1, h / 6);
    s = step(s, k2, h / 3);
    s = step(s, k3, h / 3);
    s = step(s, k4, h / 6);
    s.q.normalize();
  }
  return s;
}

}  // namespace leviosim::traces::testing
