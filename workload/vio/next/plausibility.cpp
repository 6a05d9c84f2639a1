#include "workload/vio/next/plausibility.h"

#include "workload/vio/stages.h"

namespace leviosim::vio {

/// The comparisons are not true either of what is not a number.
template <class P>
bool map_is_plausible(const FrontEndState<P>& state, const Prediction<P>& prediction, bool stays) {
  using F = typename P::F32;
  const auto stage = state.machine.stage(stages::kGuided);
  const RecoveryOptions& limits = state.profile.recovery;
  const KeyframeState<P> last = state.newest_keyframe();
  const ImuBias<P> bias = state.graph_in_l2.bias();
  const auto below = [](const Vec3<P>& v, float limit) { return dot(v, v) < F(limit * limit); };
  return below(last.velocity, limits.max_speed) && below(bias.gyro, limits.max_gyro_bias) &&
         below(bias.accel, limits.max_accel_bias) &&
         (!stays ||
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

template bool map_is_plausible(const FrontEndState<work::Native>&, const Prediction<work::Native>&,
                               bool);
template bool map_is_plausible(const FrontEndState<work::Counting>&,
                               const Prediction<work::Counting>&, bool);
template bool pose_is_plausible(const FrontEndState<work::Native>&, const Prediction<work::Native>&,
                                const Pose<work::Native>&, float);
template bool pose_is_plausible(const FrontEndState<work::Counting>&,
                                const Prediction<work::Counting>&, const Pose<work::Counting>&,
                                float);
template bool agrees_with_gyro(const FrontEndState<work::Native>&,
                               const InertialPart<work::Native>&, const Mat3<work::Native>&);
template bool agrees_with_gyro(const FrontEndState<work::Counting>&,
                               const InertialPart<work::Counting>&, const Mat3<work::Counting>&);

}  // namespace leviosim::vio
