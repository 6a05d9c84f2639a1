// What the pre-integrated IMU says about two consecutive keyframes: residuals (paper eqs 2 to 4, in
// section III.C) and their derivatives.
//
// Perturbations: rotation on the right, R ← R exp(φ) (φ in the camera frame); position, velocity,
// gravity and biases additive, in the frame they are given in.
//
// Gravity g points down and enters as acceleration: a vehicle at rest measures the specific force
// -R_camera_world g.
#pragma once

#include "workload/inertial/preintegration.h"
#include "workload/inertial/record_sums.h"

namespace leviosim::vio {

template <class P>
struct KeyframeState {
  Pose<P> T_world_camera;
  Vec3<P> velocity;  ///< of the camera in the world frame, m/s
};

template <class P>
struct ImuResidual {
  Vec3<P> rotation;  ///< rad, in the camera frame at the end
  Vec3<P> velocity;  ///< m/s, in the camera frame at the begin
  Vec3<P> position;  ///< m, in the camera frame at the begin
};

/// Derivatives by the states at the begin (0) and at the end (1); those not listed are zero:
///   velocity by v1 = Rt, by v0 = -Rt, by gravity = -dt Rt;
///   position by p1 = Rt, by p0 = -Rt, by v0 = -dt Rt, by gravity = -dt²/2 Rt.
template <class P>
struct ImuJacobians {
  Mat3<P> rotation_by_rotation0;
  Mat3<P> rotation_by_rotation1;
  Mat3<P> velocity_by_rotation0;
  Mat3<P> position_by_rotation0;
  Mat3<P> Rt;  ///< R_camera0_world
};

/// Changes of velocity and position free of gravity, in the camera frame at the begin: what ΔV and
/// ΔP are compared with.
template <class P>
struct FreeMotion {
  Vec3<P> velocity, position;
};

template <class P>
FreeMotion<P> free_motion(const KeyframeState<P>& begin, const KeyframeState<P>& end,
                          typename P::F32 dt, const Vec3<P>& gravity) {
  using F = typename P::F32;
  const Mat3<P> Rt = transpose(begin.T_world_camera.R);
  const Vec3<P> fall = gravity * dt;
  const Vec3<P> path = (begin.velocity + fall * F(0.5f)) * dt;
  return {Rt * (end.velocity - begin.velocity - fall),
          Rt * (end.T_world_camera.t - begin.T_world_camera.t - path)};
}

template <class P>
ImuResidual<P> imu_residual(const KeyframeState<P>& begin, const KeyframeState<P>& end,
                            const ImuDelta<P>& delta, const Vec3<P>& gravity) {
  const typename P::Function function("imu_residual");
  const FreeMotion<P> motion = free_motion<P>(begin, end, delta.dt, gravity);
  const Mat3<P> turned = transpose(begin.T_world_camera.R) * end.T_world_camera.R;
  return {so3_log<P>(transpose(delta.R) * turned), motion.velocity - delta.v,
          motion.position - delta.p};
}

/// @param residual  of the same states
template <class P>
ImuJacobians<P> imu_jacobians(const KeyframeState<P>& begin, const KeyframeState<P>& end,
                              typename P::F32 dt, const Vec3<P>& gravity,
                              const ImuResidual<P>& residual) {
  using F = typename P::F32;
  const typename P::Function function("imu_jacobians");
  const FreeMotion<P> motion = free_motion<P>(begin, end, dt, gravity);
  ImuJacobians<P> J;
  J.Rt = transpose(begin.T_world_camera.R);
  J.rotation_by_rotation1 = so3_right_jacobian_inverse<P>(residual.rotation);
  const Mat3<P> R_end_begin = transpose(end.T_world_camera.R) * begin.T_world_camera.R;
  J.rotation_by_rotation0 = scaled<P>(F(-1.0f), J.rotation_by_rotation1 * R_end_begin);
  J.velocity_by_rotation0 = skew<P>(motion.velocity);
  J.position_by_rotation0 = skew<P>(motion.position);
  return J;
}

/// Derivatives by the biases. Those by the accelerometer bias are -velocity_by_accel() and
/// -position_by_accel() of the interval; velocity and position by the gyro bias in the same way.
/// @param bias  at which `residual` was computed
template <class P>
Mat3<P> rotation_residual_by_gyro_bias(const Preintegration<P>& interval, const ImuBias<P>& bias,
                                       const ImuResidual<P>& residual) {
  using F = typename P::F32;
  const typename P::Function function("rotation_residual_by_gyro_bias");
  const Mat3<P> by_gyro = interval.rotation_by_gyro();
  const Vec3<P> correction = by_gyro * (bias.gyro - interval.bias().gyro);
  const Mat3<P> inner = so3_right_jacobian<P>(correction) * by_gyro;
  // One call a statement: the order of operands is the compiler's, that of calls is not.
  const Mat3<P> by_rotation = so3_right_jacobian_inverse<P>(residual.rotation);
  const Mat3<P> outer = by_rotation * so3_exp<P>(-residual.rotation);
  return scaled<P>(F(-1.0f), outer * inner);
}

}  // namespace leviosim::vio
