// Gravity and gyro bias from the IMU alone: at the start from the first samples, and again whenever
// the vehicle stands still (PARAMETERS.md#standstill).
//
// Standing still: the readings of the last second scatter little. The thresholds lie between what
// EuRoC shows of a vehicle on the ground (gyro 0.004 to 0.04 rad/s, accelerometer 0.06 to 0.45
// m/s², the larger values with idling rotors) and one that moves, on a rope or in flight (from 0.07
// rad/s). Left out: a vehicle in straight uniform motion, which no IMU can tell from one at rest; a
// caller that knows the parallax of the images should ask for it as well.
#pragma once

#include "workload/inertial/imu.h"
#include "workload/math/rotations.h"
#include "workload/math/trig.h"

namespace leviosim::vio {

/// Gravity in the world frame of a camera whose mean specific force is known: it points against the
/// force and has the magnitude kGravity. A force of zero gives a vector that is not finite.
template <class P>
Vec3<P> gravity_from_force(const Vec3<P>& mean_accel, const Mat3<P>& R_world_camera) {
  using F = typename P::F32;
  const typename P::Function function("gravity_from_force");
  return R_world_camera * mean_accel * F(F(-kGravity) / norm(mean_accel));
}

/// Attitude of a camera in a world whose z axis points up, from its mean specific force (not
/// necessarily of unit length). The heading is free: the world's x axis is where the camera looks,
/// or, if that is nearly up or down, the camera's x axis. Without a force the camera is taken to be
/// upright, its y axis pointing down.
template <class P>
Mat3<P> upright_rotation(const Vec3<P>& force) {
  using F = typename P::F32;
  const typename P::Function function("upright_rotation");
  const F size = norm(force);
  Vec3<P> up{0.0f, -1.0f, 0.0f};
  if (size > 0.0f) up = force * F(F(1.0f) / size);
  Vec3<P> ahead{0.0f, 0.0f, 1.0f};
  if (work::abs(up.z) > F(0.9f)) ahead = {1.0f, 0.0f, 0.0f};
  const Vec3<P> level = ahead - up * F(dot(ahead, up));
  const Vec3<P> x = level * F(F(1.0f) / norm(level));
  const Vec3<P> y = cross(up, x);
  return {{{x.x, x.y, x.z}, {y.x, y.y, y.z}, {up.x, up.y, up.z}}};
}

/// The attitude nearest to R_world_camera that has the specific force (in the camera frame, not
/// zero) point up, along the world's z axis.
template <class P>
Mat3<P> levelled(const Mat3<P>& R_world_camera, const Vec3<P>& force) {
  using F = typename P::F32;
  const typename P::Function function("levelled");
  const Vec3<P> up = R_world_camera * (force * F(F(1.0f) / norm(force)));
  const Vec3<P> axis{up.y, -up.x, 0.0f};  // up × z, of length sin(angle)
  const F sine = norm(axis);
  if (!(sine > F(1e-6f))) return R_world_camera;  // upright within single precision
  return so3_exp<P>(axis * F(atan2_of<P>(sine, up.z) / sine)) * R_world_camera;
}

/// Mean specific force of the first n samples of a batch in memory (n ≥ 1). The vehicle need not be
/// at rest: over a second, accelerations of a vehicle that goes nowhere cancel in good part.
template <class P, class Span>
Vec3<P> mean_force(const Span& batch, int n) {
  using F = typename P::F32;
  const typename P::Function function("mean_force");
  Vec3<P> sum{0.0f, 0.0f, 0.0f};
  for (int i : P::range(0, n)) sum = sum + load_imu_sample<P>(batch, i).accel;
  return sum * F(F(1.0f) / F(static_cast<float>(n)));
}

/// Standing still (PARAMETERS.md#standstill); the thresholds are explained above.
struct StillnessOptions {
  int batches = 20;            ///< looked at: one second of batches of one frame each
  float gyro_stddev = 0.04f;   ///< above this the vehicle moves, rad/s
  float accel_stddev = 0.45f;  ///< m/s²
};

template <class P>
struct Stillness {
  using F = typename P::F32;

  bool still;
  Vec3<P> gyro_mean;       ///< the gyro bias, if still, rad/s
  Vec3<P> accel_mean;      ///< minus gravity in the camera frame, if still, m/s²
  F gyro_variance = 0.0f;  ///< summed over the axes, rad²/s²
};

/// Sums over the last batches of samples, one batch per frame, kept in memory.
template <class P>
class StillnessDetector {
 public:
  using F = typename P::F32;
  using Span = typename P::template Span<F>;

  static constexpr int kBatchFloats = 9;
  static constexpr int floats(const StillnessOptions& options) {
    return kBatchFloats * options.batches;
  }

  /// @param memory  floats(options) of them, uninitialised
  StillnessDetector(const StillnessOptions& options, Span memory)
      : options_(options), memory_(memory) {
    for (int i : P::range(0, floats(options_))) memory_[i] = 0.0f;
  }

  /// The sums lie here from now on, copied by the caller (between L2 and a core's own memory).
  void move_to(Span memory) { memory_ = memory; }

  /// Adds one sample to the batch of the current frame.
  void add(const ImuSample<P>& sample) {
    const Span batch = memory_.subspan(current_ * kBatchFloats, kBatchFloats);
    store_vec3<P>(batch, kGyro, load_vec3<P>(batch, kGyro) + sample.gyro);
    store_vec3<P>(batch, kAccel, load_vec3<P>(batch, kAccel) + sample.accel);
    batch[kGyroSq] += F(dot(sample.gyro, sample.gyro));
    batch[kAccelSq] += F(dot(sample.accel, sample.accel));
    batch[kSamples] += F(1.0f);
  }

  /// Closes the batch of the current frame; the oldest one is forgotten.
  void end_frame() {
    if (closed_ < options_.batches) ++closed_;
    current_ = current_ + 1 == options_.batches ? 0 : current_ + 1;
    for (int i : P::range(0, kBatchFloats)) memory_[current_ * kBatchFloats + i] = 0.0f;
  }

  /// Never still before all batches have been filled once. Call right before end_frame(), when the
  /// batch of the current frame is complete.
  Stillness<P> evaluate() const {
    const typename P::Function function("StillnessDetector::evaluate");
    Vec3<P> gyro{0.0f, 0.0f, 0.0f}, accel{0.0f, 0.0f, 0.0f};
    F gyro_sq = 0.0f, accel_sq = 0.0f, samples = 0.0f;
    for (int i : P::range(0, options_.batches)) {
      const Span batch = memory_.subspan(i * kBatchFloats, kBatchFloats);
      gyro = gyro + load_vec3<P>(batch, kGyro);
      accel = accel + load_vec3<P>(batch, kAccel);
      gyro_sq += F(batch[kGyroSq]);
      accel_sq += F(batch[kAccelSq]);
      samples += F(batch[kSamples]);
    }
    const F scale = F(1.0f) / work::max(samples, F(1.0f));
    gyro = gyro * scale;
    accel = accel * scale;
    const F gyro_variance = gyro_sq * scale - dot(gyro, gyro);
    const F accel_variance = accel_sq * scale - dot(accel, accel);
    bool still = closed_ + 1 >= options_.batches;
    if (gyro_variance > options_.gyro_stddev * options_.gyro_stddev) still = false;
    if (accel_variance > options_.accel_stddev * options_.accel_stddev) still = false;
    return {still, gyro, accel, gyro_variance};
  }

  /// If still: with the means of the older half of the batches, so that a motion which has begun,
  /// but is not distinguished from rest yet, is not taken for a bias. Call as evaluate().
  Stillness<P> without_recent(const Stillness<P>& seen) const {
    Vec3<P> gyro{0.0f, 0.0f, 0.0f}, accel{0.0f, 0.0f, 0.0f};
    F samples = 0.0f;
    for (int i : P::range(0, options_.batches / 2)) {
      const int at = (current_ + 1 + i) % options_.batches;  // the oldest first
      const Span batch = memory_.subspan(at * kBatchFloats, kBatchFloats);
      gyro = gyro + load_vec3<P>(batch, kGyro);
      accel = accel + load_vec3<P>(batch, kAccel);
      samples += F(batch[kSamples]);
    }
    if (!(samples > F(0.0f))) return seen;
    const F scale = F(1.0f) / samples;
    return {seen.still, gyro * scale, accel * scale, seen.gyro_variance};
  }

 private:
  enum Place : int { kGyro = 0, kAccel = 3, kGyroSq = 6, kAccelSq = 7, kSamples = 8 };

  StillnessOptions options_;
  Span memory_;
  int current_ = 0;
  int closed_ = 0;
};

}  // namespace leviosim::vio
