#include "workload/next/prediction.h"

#include "workload/next/motion_record.h"
#include "workload/next/plausibility.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {

/// A product with an inverse, which for a rotation is its transpose, triples what keeps it from
/// being a rotation: without the correction a second at rest, where one such pose follows from the
/// other, is enough to lose it.
template <class P>
Pose<P> Prediction<P>::last_pose() const {
  const Pose<P> T = state_.newest_keyframe().T_world_camera * motion_.T_keyframe_camera();
  return {orthonormalised<P>(T.R), T.t};
}

template <class P>
bool Prediction<P>::window_is_full() const {
  using I32 = typename P::I32;
  return bool(state_.graph_in_l2.keyframe_count() == I32(state_.graph.capacity.keyframes));
}

/// Velocities are good to some cm/s. Differences of two frames' positions, the alternative, have
/// the noise of both and feed it back; where there are none it is the IMU or nothing.
template <class P>
bool Prediction<P>::imu_predicts() const {
  const Profile& profile = state_.profile;
  const float longest = lost_ ? profile.recovery.max_blind_time : profile.max_translation_time;
  return profile.optimiser.joint && state_.time_since_keyframe < longest &&
         (map_.aligned || window_is_full());
}

template <class P>
Pose<P> Prediction<P>::by_motion(const TrackedFrame<P>& frame) const {
  using F = typename P::F32;
  const Pose<P>& last = frame.T_world_last;
  const Vec3<P> moved = last.R * (motion_.velocity() * F(frame.dt));
  if (!state_.profile.use_imu) return {last.R, last.t + moved};
  const Mat3<P> turn = transpose(motion_.gyro_rotation()) * inertial_.motion_since_keyframe().R;
  return {last.R * turn, last.t + moved};
}

template <class P>
void Prediction<P>::follow_alignment() {
  const auto stage = state_.machine.stage(stages::kGuided);
  motion_.store(motion_.T_keyframe_camera(), motion_.velocity(), motion_.gyro_rotation(),
                last_pose());
}

template <class P>
void Prediction<P>::remember(const TrackedFrame<P>& frame, const FrameReport& report) {
  using F = typename P::F32;
  const auto stage = state_.machine.stage(stages::kGuided);
  lost_ = report.source == PoseSource::Predicted;
  const Pose<P>& T = frame.T_world_camera;
  const Pose<P> T_world_keyframe = state_.newest_keyframe().T_world_camera;
  Vec3<P> velocity{0.0f, 0.0f, 0.0f};
  if (frame.dt > 0.0f && state_.frame_number > 1)
    velocity = transpose(T.R) * ((T.t - frame.T_world_last.t) * F(1.0f / frame.dt));
  const Mat3<P> turned =
      report.keyframe ? Mat3<P>::identity() : inertial_.motion_since_keyframe().R;
  motion_.store(inverse(T_world_keyframe) * T, velocity, turned, T);
}

template class Prediction<work::Native>;
template class Prediction<work::Counting>;

/// NaN fails each comparison.
template <class P>
bool map_is_plausible(const FrontEndState<P>& state, const Prediction<P>& prediction,
                      bool is_aligned) {
  using F = typename P::F32;
  const auto stage = state.machine.stage(stages::kGuided);
  const RecoveryOptions& limits = state.profile.recovery;
  const KeyframeState<P> last = state.newest_keyframe();
  const ImuBias<P> bias = state.graph_in_l2.bias();
  const auto below = [](const Vec3<P>& v, float limit) { return dot(v, v) < F(limit * limit); };
  return below(last.velocity, limits.max_speed) && below(bias.gyro, limits.max_gyro_bias) &&
         below(bias.accel, limits.max_accel_bias) &&
         (!is_aligned ||
          pose_is_plausible(state, prediction, last.T_world_camera, state.time_since_keyframe));
}

template <class P>
bool pose_is_plausible(const FrontEndState<P>& state, const Prediction<P>& prediction,
                       const Pose<P>& T_world_camera, float seconds) {
  using F = typename P::F32;
  const Vec3<P> moved = T_world_camera.t - prediction.last_reported().t;
  const RecoveryOptions& limits = state.profile.recovery;
  const float limit = limits.max_speed * seconds + limits.max_correction;
  const Mat3<P>& R = T_world_camera.R;
  const F size = dot(R.row(0), R.row(0)) + dot(R.row(1), R.row(1)) + dot(R.row(2), R.row(2));
  // The rows of a rotation are of length 1: three within what rounding does to them.
  return dot(moved, moved) < F(limit * limit) && size > F(2.9f) && size < F(3.1f);
}

template <class P>
bool agrees_with_gyro(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                      const Mat3<P>& R_camera_keyframe) {
  using F = typename P::F32;
  const Profile& profile = state.profile;
  const float limit = profile.recovery.max_gyro_difference +
                      profile.optimiser.prior.gyro_bias * state.time_since_keyframe;
  const auto& R = (R_camera_keyframe * inertial.motion_since_keyframe().R).m;
  // The trace is 1 + 2 cos(angle).
  return bool(F(3.0f) - (R[0][0] + R[1][1] + R[2][2]) < F(limit * limit));
}

#define LEVIOSIM_INSTANTIATE(P)                                                                  \
  template bool map_is_plausible(const FrontEndState<P>&, const Prediction<P>&, bool);           \
  template bool pose_is_plausible(const FrontEndState<P>&, const Prediction<P>&, const Pose<P>&, \
                                  float);                                                        \
  template bool agrees_with_gyro(const FrontEndState<P>&, const InertialPart<P>&, const Mat3<P>&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
