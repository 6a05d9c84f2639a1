// What the inertial part of the pipeline works with: samples, noise, biases.
//
// Frames: the *camera* frame is the body. Gyro and accelerometer samples arrive rotated into it;
// the lever arm between the two sensors is left out, as in the paper's embedded pipeline
// (PARAMETERS.md#input).
#pragma once

#include "workload/inertial/record.h"
#include "workload/math/vec.h"

namespace leviosim::vio {

/// One IMU reading.
template <class P>
struct ImuSample {
  typename P::F32 dt;  ///< since the sample before, s
  Vec3<P> gyro;        ///< angular rate of the camera frame, rad/s
  Vec3<P> accel;       ///< specific force in the camera frame, m/s²: what is not gravity
};

/// Floats of one sample in memory: dt, gyro, accel.
inline constexpr int kImuSampleFloats = 7;

/// Sample `i` of a batch in memory.
template <class P, class Span>
ImuSample<P> load_imu_sample(const Span& batch, int i) {
  const int at = i * kImuSampleFloats;
  return {batch[at], load_vec3<P>(batch, at + 1), load_vec3<P>(batch, at + 4)};
}

/// Noise as the paper's pipeline uses it, tuned far above what the sensor specifies
/// (PARAMETERS.md#pre-integration).
struct ImuNoise {
  float gyro = 0.02f;        ///< density, rad/s/√Hz
  float accel = 0.1f;        ///< density, m/s²/√Hz
  float gyro_bias = 2e-5f;   ///< random walk, rad/s²/√Hz
  float accel_bias = 3e-4f;  ///< random walk, m/s³/√Hz
  float gravity = 1.0f;      ///< standard deviation of each component of the gravity vector, m/s²
};

/// When a sample cannot be relied on, and the noise densities that are assumed of it then: an axis
/// at the end of its range has seen less than there was, and of what happened between samples far
/// apart the two ends tell little. Such errors keep their sign, so the densities are those that
/// give what a small vehicle does unseen (1 rad/s, 3 m/s²) after some tenths of a second.
struct ImuUncertainty {
  bool enabled = false;
  float gyro_range = 17.4f;    ///< of the sensor, ± rad/s: ADIS16448, 1000 °/s
  float accel_range = 176.0f;  ///< likewise, ± m/s²: 18 g
  float longest_step = 0.02f;  ///< s
  float gyro = 0.5f;           ///< rad/s/√Hz
  float accel = 1.5f;          ///< m/s²/√Hz
};

/// Magnitude of gravity, m/s² (PARAMETERS.md#pre-integration).
inline constexpr float kGravity = 9.81f;

template <class P>
struct ImuBias {
  Vec3<P> gyro;   ///< rad/s
  Vec3<P> accel;  ///< m/s²

  static ImuBias zero() { return {{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}}; }
};

}  // namespace leviosim::vio
