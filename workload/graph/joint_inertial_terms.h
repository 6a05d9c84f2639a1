// The inertial part of the optimiser with the biases as unknowns: six that all keyframes of the
// window share (gyro, then accelerometer), since in the seconds that a window lasts they hardly
// walk. Between windows they do (marginalisation.h).
//
// Gravity is known: the world's z axis points up. The window's lever arm is the place of the IMU in
// the camera frame; residuals are those of the IMU's path, which a turning camera does not share:
// 7 cm and a turn that changes by 5 rad/s² make 0.35 m/s².
#pragma once

#include "workload/graph/reduced_system.h"
#include "workload/graph/window.h"

namespace leviosim::vio {

/// Unknowns that the keyframes share.
inline constexpr int kBiasUnknowns = 6;

/// Scratch for one interval: 9 rows; derivatives by both keyframes (18) and the biases (6), then
/// the residual.
template <class P>
struct JointScratch {
  static constexpr int kColumns = 25;

  explicit JointScratch(work::Arena& arena)
      : rows(alloc_matrix<P>(arena, "interval Jacobian", 9, kColumns)) {}

  MatrixView<P> rows;
};

/// A keyframe with the position of the IMU in place of the camera's.
template <class P>
KeyframeState<P> imu_state(const KeyframeState<P>& camera, const Vec3<P>& lever_arm) {
  const Pose<P>& T = camera.T_world_camera;
  return {{T.R, T.t + T.R * lever_arm}, camera.velocity};
}

/// Residual of an interval and its derivatives, not whitened, into rows of JointScratch.
template <class P>
void linearise_interval(const Preintegration<P>& interval, const KeyframeState<P>& begin,
                        const KeyframeState<P>& end, const ImuBias<P>& bias, const Vec3<P>& gravity,
                        const Vec3<P>& lever_arm, MatrixView<P> rows);

/// Adds intervals first … last (interval k ends at keyframe k) at the window's state.
/// @param system  9 unknowns per keyframe and 6 shared ones
/// @return their cost
template <class P>
typename P::F32 add_joint_inertial_terms(const Window<P>& window, int first, int last,
                                         const JointScratch<P>& scratch,
                                         const ReducedSystem<P>& system);

/// Cost of all intervals at `state` and `bias`.
template <class P>
typename P::F32 joint_inertial_cost(const Window<P>& window, const WindowState<P>& state,
                                    const ImuBias<P>& bias, const JointScratch<P>& scratch);

}  // namespace leviosim::vio
