#include "workload/graph/joint_inertial_terms.h"

#include "workload/graph/interval_rows.h"

namespace leviosim::vio {
namespace {

using namespace interval;

// Columns: both keyframes, then gyro and accelerometer.
constexpr int kGyroColumn = 18;  ///< first column of the biases
constexpr int kAccelColumn = 21;
constexpr int kJointResidual = 24;  ///< column of the residual

template <class P>
void store_state_jacobians(MatrixView<P> rows, const KeyframeState<P>& end,
                           const ImuJacobians<P>& J, typename P::F32 dt, const Vec3<P>& lever_arm) {
  using F = typename P::F32;
  const Mat3<P> minus_Rt = scaled<P>(F(-1.0f), J.Rt);
  const Mat3<P> R_begin_end = J.Rt * end.T_world_camera.R;
  store_block<P>(rows, 0, 0, J.rotation_by_rotation0);
  store_block<P>(rows, 0, kEnd, J.rotation_by_rotation1);
  store_block<P>(rows, kVelocityRow, 0, J.velocity_by_rotation0);
  store_block<P>(rows, kVelocityRow, kVelocityColumn, minus_Rt);
  store_block<P>(rows, kVelocityRow, kEnd + kVelocityColumn, J.Rt);
  // Where the IMU is turns with the camera, at both ends.
  store_block<P>(rows, kPositionRow, 0, J.position_by_rotation0 + skew<P>(lever_arm));
  store_block<P>(rows, kPositionRow, kEnd, times_skew<P>(R_begin_end, -lever_arm));
  store_block<P>(rows, kPositionRow, kPositionColumn, minus_Rt);
  store_block<P>(rows, kPositionRow, kVelocityColumn, scaled<P>(dt, minus_Rt));
  store_block<P>(rows, kPositionRow, kEnd + kPositionColumn, J.Rt);
}

template <class P>
void store_bias_jacobians(MatrixView<P> rows, const Preintegration<P>& interval,
                          const ImuBias<P>& bias, const ImuResidual<P>& residual) {
  using F = typename P::F32;
  const F minus = -1.0f;
  store_block<P>(rows, 0, kGyroColumn, rotation_residual_by_gyro_bias<P>(interval, bias, residual));
  store_block<P>(rows, kVelocityRow, kGyroColumn, scaled<P>(minus, interval.velocity_by_gyro()));
  store_block<P>(rows, kVelocityRow, kAccelColumn, scaled<P>(minus, interval.velocity_by_accel()));
  store_block<P>(rows, kPositionRow, kGyroColumn, scaled<P>(minus, interval.position_by_gyro()));
  store_block<P>(rows, kPositionRow, kAccelColumn, scaled<P>(minus, interval.position_by_accel()));
}

/// H += Jᵀ J and b -= Jᵀ r.
template <class P>
void add_joint_rows(MatrixView<P> rows, const ReducedSystem<P>& system, int keyframe) {
  using F = typename P::F32;
  const typename P::Function function("add_joint_rows");
  const MatrixView<P> matrix = system.matrix();
  const int base = keyframe * system.per_keyframe();
  const auto place = [&](int c) {
    return c < kGyroColumn ? base + c : system.shared() + c - kGyroColumn;
  };
  for (int i : P::range(0, kJointResidual)) {
    for (int j : P::range(0, i + 1)) {
      F sum = matrix(place(i), place(j));
      for (int r : P::range(0, 9)) sum += rows(r, i) * rows(r, j);
      matrix(place(i), place(j)) = sum;
    }
    F b = system.vector()[place(i)];
    for (int r : P::range(0, 9)) b -= rows(r, i) * rows(r, kJointResidual);
    system.vector()[place(i)] = b;
  }
}

}  // namespace

template <class P>
void linearise_interval(const Preintegration<P>& interval, const KeyframeState<P>& begin,
                        const KeyframeState<P>& end, const ImuBias<P>& bias, const Vec3<P>& gravity,
                        const Vec3<P>& lever_arm, MatrixView<P> rows) {
  const typename P::Function function("linearise_interval");
  const KeyframeState<P> from = imu_state<P>(begin, lever_arm), to = imu_state<P>(end, lever_arm);
  const ImuDelta<P> delta = interval.corrected(bias);
  const ImuResidual<P> residual = imu_residual<P>(from, to, delta, gravity);
  fill<P>(rows, 0.0f);
  store_residual<P>(rows, residual);
  const ImuJacobians<P> J = imu_jacobians<P>(from, to, delta.dt, gravity, residual);
  store_state_jacobians<P>(rows, to, J, delta.dt, lever_arm);
  store_bias_jacobians<P>(rows, interval, bias, residual);
}

template <class P>
typename P::F32 add_joint_inertial_terms(const Window<P>& window, int first, int last,
                                         const JointScratch<P>& scratch,
                                         const ReducedSystem<P>& system) {
  using F = typename P::F32;
  const typename P::Function function("add_joint_inertial_terms");
  F cost = 0.0f;
  for (int k : P::range(first, last + 1)) {
    const Preintegration<P> interval = window.interval(k);
    if (!(interval.duration() > 0.0f)) continue;
    linearise_interval<P>(interval, window.state.keyframe(k - 1), window.state.keyframe(k),
                          window.bias, window.gravity, window.lever_arm, scratch.rows);
    whiten<P>(interval, scratch.rows, 0, JointScratch<P>::kColumns);
    add_joint_rows<P>(scratch.rows, system, k - 1);
    cost += half_square_of_residual<P>(scratch.rows);
  }
  return cost;
}

template <class P>
typename P::F32 joint_inertial_cost(const Window<P>& window, const WindowState<P>& state,
                                    const ImuBias<P>& bias, const JointScratch<P>& scratch) {
  using F = typename P::F32;
  const typename P::Function function("joint_inertial_cost");
  F cost = 0.0f;
  for (int k : P::range(1, window.keyframes)) {
    const Preintegration<P> interval = window.interval(k);
    if (!(interval.duration() > 0.0f)) continue;
    store_residual<P>(scratch.rows,
                      imu_residual<P>(imu_state<P>(state.keyframe(k - 1), window.lever_arm),
                                      imu_state<P>(state.keyframe(k), window.lever_arm),
                                      interval.corrected(bias), window.gravity));
    whiten<P>(interval, scratch.rows, kJointResidual, kJointResidual + 1);
    cost += half_square_of_residual<P>(scratch.rows);
  }
  return cost;
}

#define LEVIOSIM_INSTANTIATE(P)                                                                   \
  template void linearise_interval(const Preintegration<P>&, const KeyframeState<P>&,             \
                                   const KeyframeState<P>&, const ImuBias<P>&, const Vec3<P>&,    \
                                   const Vec3<P>&, MatrixView<P>);                                \
  template P::F32 add_joint_inertial_terms(const Window<P>&, int, int, const JointScratch<P>&,    \
                                           const ReducedSystem<P>&);                              \
  template P::F32 joint_inertial_cost(const Window<P>&, const WindowState<P>&, const ImuBias<P>&, \
                                      const JointScratch<P>&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
