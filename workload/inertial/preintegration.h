// IMU pre-integration between two keyframes (paper section III.C; Forster et al., "On-manifold
// preintegration", is the method it names): rotation, velocity and position change in the camera
// frame of the first keyframe, their derivatives by the biases, and their covariance.
//
// One trapezoidal step per sample: the mean of two gyro readings turns the frame, and the mean of
// two specific forces, each rotated into the frame of the first keyframe, accelerates it.
//
// Error state of the covariance, in this order: rotation (right perturbation,
// ΔR_true = ΔR exp(φ)), velocity, position. White noise of density σ over a step dt adds σ² dt to
// rotation or velocity, and σ² (dt²/2, dt³/3) to velocity-position and position, its exact
// integral, so that the covariance is positive definite from the first sample on.
//
// Left out: the noise of the gyro inside the step in which it also turns the specific force, the
// rotation of isotropic noise by the right Jacobian (both of the order of the angle of one step,
// 0.01 rad), and the random walk of the biases inside one interval (they are estimated
// separately, bias_estimation.h).
#pragma once

#include "workload/inertial/imu.h"
#include "workload/inertial/record_sums.h"
#include "workload/math/matrix.h"
#include "workload/math/rotations.h"

namespace leviosim::vio {

/// Motion over an interval as the IMU saw it, in the camera frame at its begin.
template <class P>
struct ImuDelta {
  Mat3<P> R;           ///< R_begin_end
  Vec3<P> v;           ///< velocity gained, without gravity, m/s
  Vec3<P> p;           ///< distance gained over the initial velocity, without gravity, m
  typename P::F32 dt;  ///< s
};

/// The record of one interval in memory: 148 floats, 592 bytes. A view: copies share the record.
template <class P>
class Preintegration {
 public:
  using F = typename P::F32;
  using Span = typename P::template Span<F>;

  static constexpr int kFloats = 148;
  /// Of these, without the covariance: all that corrected() reads.
  static constexpr int kMotionFloats = 67;

  Preintegration() = default;
  /// @param record  kFloats floats, uninitialised until reset()
  explicit Preintegration(Span record) : record_(record) {}

  /// Starts an interval of no length. `bias` is what will be subtracted from the samples.
  void reset(const ImuBias<P>& bias) const;

  /// Adds the step from one sample to the next, of length current.dt.
  void integrate(const ImuSample<P>& previous, const ImuSample<P>& current,
                 const ImuNoise& noise) const;

  /// The motion, corrected to first order for biases other than those subtracted.
  ImuDelta<P> corrected(const ImuBias<P>& bias) const;

  /// The motion with the biases given to reset().
  ImuDelta<P> delta() const {
    return {rotation(), load_vec3<P>(record_, kVelocity), load_vec3<P>(record_, kPosition),
            duration()};
  }
  ImuBias<P> bias() const {
    return {load_vec3<P>(record_, kBiasGyro), load_vec3<P>(record_, kBiasAccel)};
  }
  F duration() const { return record_[kDuration]; }
  Mat3<P> rotation() const { return load_mat3<P>(record_, kRotation); }
  /// Derivatives of the motion: rotation in its right perturbation, velocity and position additive.
  Mat3<P> rotation_by_gyro() const { return load_mat3<P>(record_, kRotationByGyro); }
  Mat3<P> velocity_by_gyro() const { return load_mat3<P>(record_, kVelocityByGyro); }
  Mat3<P> velocity_by_accel() const { return load_mat3<P>(record_, kVelocityByAccel); }
  Mat3<P> position_by_gyro() const { return load_mat3<P>(record_, kPositionByGyro); }
  Mat3<P> position_by_accel() const { return load_mat3<P>(record_, kPositionByAccel); }

  /// 9×9, of which only the 3×3 blocks on and below the diagonal are valid.
  MatrixView<P> covariance() const { return {record_.subspan(kCovariance, 81), 9, 9}; }
  Span record() const { return record_; }
  /// Marks an interval that constrains nothing.
  void clear() const { record_[kDuration] = 0.0f; }

 private:
  enum Place : int {
    kRotation = 0,
    kVelocity = 9,
    kPosition = 12,
    kDuration = 15,
    kBiasGyro = 16,
    kBiasAccel = 19,
    kRotationByGyro = 22,
    kVelocityByGyro = 31,
    kVelocityByAccel = 40,
    kPositionByGyro = 49,
    kPositionByAccel = 58,
    kCovariance = 67,
  };
  static_assert(kCovariance == kMotionFloats && kCovariance + 81 == kFloats);

  /// What one step does to all parts of the record.
  struct Step {
    F dt;
    Mat3<P> turn;          ///< rotation during the step
    Mat3<P> turn_by_gyro;  ///< minus its derivative by the gyro bias
    Mat3<P> R, next_R;     ///< rotation before and after
    Vec3<P> gained;        ///< velocity gained
    Mat3<P> gained_by_rotation;
    Mat3<P> gained_by_gyro;  ///< directly, besides through the rotation before
  };
  Step make_step(const ImuSample<P>& previous, const ImuSample<P>& current) const;
  void advance_covariance(const Step& step, const ImuNoise& noise) const;
  void advance_bias_derivatives(const Step& step) const;
  void advance_motion(const Step& step) const;
  Mat3<P> covariance_block(int r, int c) const {
    return load_mat3<P>(record_, kCovariance + 9 * r + c, 9);
  }
  void store_covariance_block(int r, int c, const Mat3<P>& block) const {
    store_mat3<P>(record_, kCovariance + 9 * r + c, block, 9);
  }

  Span record_;
};

template <class P>
void Preintegration<P>::reset(const ImuBias<P>& bias) const {
  for (int i : P::range(0, kFloats)) record_[i] = 0.0f;
  for (int i = 0; i < 3; ++i) record_[kRotation + 4 * i] = 1.0f;
  store_vec3<P>(record_, kBiasGyro, bias.gyro);
  store_vec3<P>(record_, kBiasAccel, bias.accel);
}

template <class P>
void Preintegration<P>::integrate(const ImuSample<P>& previous, const ImuSample<P>& current,
                                  const ImuNoise& noise) const {
  const typename P::Function function("preintegrate");
  const Step step = make_step(previous, current);
  advance_covariance(step, noise);
  advance_bias_derivatives(step);
  advance_motion(step);
}

template <class P>
typename Preintegration<P>::Step Preintegration<P>::make_step(const ImuSample<P>& previous,
                                                              const ImuSample<P>& current) const {
  const ImuBias<P> zero = bias();
  Step step;
  step.dt = current.dt;
  const Vec3<P> angle = ((previous.gyro + current.gyro) * F(0.5f) - zero.gyro) * step.dt;
  step.turn = so3_exp<P>(angle);
  step.turn_by_gyro = scaled<P>(step.dt, so3_right_jacobian<P>(angle));
  step.R = rotation();
  step.next_R = step.R * step.turn;

  // Mean specific force in the frame at the begin of the step, times dt.
  const Vec3<P> end_force = step.turn * (current.accel - zero.accel);
  const F half = step.dt * F(0.5f);
  const Vec3<P> gained = (previous.accel - zero.accel + end_force) * half;
  step.gained = step.R * gained;
  step.gained_by_rotation = times_skew<P>(step.R, -gained);
  // The gyro bias also turns the force at the end of the step; the right Jacobian is taken as I.
  step.gained_by_gyro = times_skew<P>(step.R, end_force * F(half * step.dt));
  return step;
}

/// Σ ← A Σ Aᵀ + Q with A = [turnᵀ 0 0; G I 0; dt/2 G, dt I, I] and G = gained_by_rotation, block by
/// block: first the rows (A Σ), then the columns.
template <class P>
void Preintegration<P>::advance_covariance(const Step& step, const ImuNoise& noise) const {
  constexpr int kR = 0, kV = 3, kP = 6;
  const Mat3<P> G = step.gained_by_rotation, Gt = transpose(G);
  const Mat3<P> turn_t = transpose(step.turn);
  const F dt = step.dt, half = F(0.5f);
  const Mat3<P> RR = covariance_block(kR, kR), VR = covariance_block(kV, kR);
  const Mat3<P> PR = covariance_block(kP, kR), VV = covariance_block(kV, kV);
  const Mat3<P> PV = covariance_block(kP, kV), PP = covariance_block(kP, kP);

  const Mat3<P> G_RR = G * RR, G_RV = G * transpose(VR), G_RP = G * transpose(PR);
  const Mat3<P> rows_RR = turn_t * RR;
  const Mat3<P> rows_VR = VR + G_RR;
  const Mat3<P> rows_PR = add_scaled<P>(PR, dt, add_scaled<P>(VR, half, G_RR));
  const Mat3<P> rows_VV = VV + G_RV;
  const Mat3<P> rows_PV = add_scaled<P>(PV, dt, add_scaled<P>(VV, half, G_RV));
  const Mat3<P> rows_PP = add_scaled<P>(PP, dt, add_scaled<P>(transpose(PV), half, G_RP));

  const F turn_noise = F(noise.gyro * noise.gyro) * dt;
  const F velocity_noise = F(noise.accel * noise.accel) * dt;
  const F cross_noise = velocity_noise * dt * half;
  const F position_noise = cross_noise * dt * F(2.0f / 3.0f);
  const Mat3<P> columns_PV = rows_PR * Gt;
  store_covariance_block(kR, kR, add_diagonal<P>(rows_RR * step.turn, turn_noise));
  store_covariance_block(kV, kR, rows_VR * step.turn);
  store_covariance_block(kP, kR, rows_PR * step.turn);
  store_covariance_block(kV, kV, add_diagonal<P>(rows_VV + rows_VR * Gt, velocity_noise));
  store_covariance_block(kP, kV, add_diagonal<P>(rows_PV + columns_PV, cross_noise));
  store_covariance_block(
      kP, kP,
      add_diagonal<P>(add_scaled<P>(rows_PP, dt, add_scaled<P>(rows_PV, half, columns_PV)),
                      position_noise));
}

template <class P>
void Preintegration<P>::advance_bias_derivatives(const Step& step) const {
  const F dt = step.dt, half = F(0.5f);
  const Mat3<P> R_by_gyro = rotation_by_gyro();
  const Mat3<P> v_by_gyro = velocity_by_gyro(), v_by_accel = velocity_by_accel();
  const Mat3<P> gyro_gain = step.gained_by_rotation * R_by_gyro + step.gained_by_gyro;
  const Mat3<P> accel_gain = scaled<P>(F(-0.5f) * dt, step.R + step.next_R);

  store_mat3<P>(record_, kPositionByGyro,
                add_scaled<P>(position_by_gyro(), dt, add_scaled<P>(v_by_gyro, half, gyro_gain)));
  store_mat3<P>(
      record_, kPositionByAccel,
      add_scaled<P>(position_by_accel(), dt, add_scaled<P>(v_by_accel, half, accel_gain)));
  store_mat3<P>(record_, kVelocityByGyro, v_by_gyro + gyro_gain);
  store_mat3<P>(record_, kVelocityByAccel, v_by_accel + accel_gain);
  store_mat3<P>(record_, kRotationByGyro,
                add_scaled<P>(transpose(step.turn) * R_by_gyro, F(-1.0f), step.turn_by_gyro));
}

template <class P>
void Preintegration<P>::advance_motion(const Step& step) const {
  const Vec3<P> v = load_vec3<P>(record_, kVelocity);
  const Vec3<P> p = load_vec3<P>(record_, kPosition);
  store_vec3<P>(record_, kPosition, p + (v + step.gained * F(0.5f)) * step.dt);
  store_vec3<P>(record_, kVelocity, v + step.gained);
  store_mat3<P>(record_, kRotation, step.next_R);
  record_[kDuration] = duration() + step.dt;
}

template <class P>
ImuDelta<P> Preintegration<P>::corrected(const ImuBias<P>& bias_now) const {
  const typename P::Function function("bias_corrected");
  const ImuBias<P> subtracted = bias();
  const Vec3<P> gyro = bias_now.gyro - subtracted.gyro;
  const Vec3<P> accel = bias_now.accel - subtracted.accel;
  const ImuDelta<P> d = delta();
  return {d.R * so3_exp<P>(rotation_by_gyro() * gyro),
          d.v + velocity_by_gyro() * gyro + velocity_by_accel() * accel,
          d.p + position_by_gyro() * gyro + position_by_accel() * accel, d.dt};
}

}  // namespace leviosim::vio
