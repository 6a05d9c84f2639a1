#include "workload/vio/next/prediction.h"

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

}  // namespace leviosim::vio
