#include "workload/vio/next/next_front_end.h"

#include "workload/vio/keyframe_insertion.h"
#include "workload/vio/keyframe_matching.h"
#include "workload/vio/map_start.h"
#include "workload/vio/next/guided_tracking.h"
#include "workload/vio/next/plausibility.h"
#include "workload/vio/parallax.h"
#include "workload/vio/stages.h"
#include "workload/vio/two_view_pose.h"

namespace leviosim::vio {

template <class P>
NextFrontEnd<P>::NextFrontEnd(const Profile& profile, const Rig& rig, work::Machine& cluster,
                              work::Arena& keyframe_memory, work::Arena& loop_memory,
                              const PoseGraph<P>& graph)
    : state_(profile, rig, cluster, keyframe_memory, graph),
      inertial_(state_),
      prediction_(state_, inertial_, keyframe_memory) {
  if (profile.loop.enabled) loop_.emplace(state_, loop_memory);
}

template <class P>
FrameReport NextFrontEnd<P>::process(const FrameInput& input) {
  const work::Arena::Frame memory(state_.machine.local());
  FrameReport report;
  TrackedFrame<P> frame;
  frame.dt = input.dt;
  take_image(input, state_);
  inertial_.integrate(input);
  extract_frame<P>(state_, frame);
  report.keyframe = true;
  if (!state_.started) {
    start_map<P>(state_, frame);
  } else if (inertial_.rest() && !prediction_.window_is_full()) {
    start_at_rest(frame);
  } else if (!map_is_plausible(state_, prediction_)) {
    start_anew(frame);
    report.map_restarts = 1;
    if (loop_) loop_->doubt();
  } else {
    locate(frame, report);
    report.keyframe = is_keyframe(frame, report);
    if (loop_) loop_->follow(frame, report);
    if (report.keyframe) insert_keyframe<P>(state_, frame);
  }
  prediction_.remember(frame, report);
  complete<P>(state_, frame, report);
  if (loop_) loop_->correct(frame, frame.dt, report);
  return report;
}

/// A vehicle that stands still before the first window is full starts anew with every frame, from
/// where the last one was: at rest, gravity and the gyro's bias can be read off and the velocity is
/// zero, while noise alone would sooner or later look like parallax, and the scale of a map with
/// few keyframes is a guess.
template <class P>
void NextFrontEnd<P>::start_at_rest(TrackedFrame<P>& frame) {
  work::Arena& local = state_.machine.local();
  const work::Arena::Frame memory(local);
  const auto stage = state_.machine.stage(stages::kTriangulation);
  const auto record = local.alloc<Floats>("IMU interval", Preintegration<P>::kFloats);
  const Stillness<P>& rest = *inertial_.rest();
  frame.T_world_last = frame.T_world_camera = prediction_.last_pose();
  Mat3<P>& R = frame.T_world_camera.R;
  R = levelled<P>(R, rest.accel_mean);
  begin_map<P>(state_, frame, record, {rest.gyro_mean, {0.0f, 0.0f, 0.0f}},
               {0.0f, 0.0f, -kGravity});
  BiasPrior<P> prior = state_.graph_in_l2.bias_prior();
  const float stddev = state_.profile.optimiser.prior.rest_gyro_bias;
  prior.gyro_information = 1.0f / (stddev * stddev);
  state_.graph_in_l2.set_bias_prior(prior);
  prediction_.begin_map(true);
}

/// What became of the map cannot be true: another one begins where the camera was seen last.
template <class P>
void NextFrontEnd<P>::start_anew(TrackedFrame<P>& frame) {
  using F = typename P::F32;
  work::Arena& local = state_.machine.local();
  const work::Arena::Frame memory(local);
  const auto stage = state_.machine.stage(stages::kTriangulation);
  const auto record = local.alloc<Floats>("IMU interval", Preintegration<P>::kFloats);
  frame.T_world_last = frame.T_world_camera = prediction_.last_reported();
  Mat3<P>& R = frame.T_world_camera.R;
  const Vec3<P>& force = inertial_.recent_force();
  if (dot(force, force) > F(0.0f)) R = levelled<P>(R, force);
  begin_map<P>(state_, frame, record, ImuBias<P>::zero(), {0.0f, 0.0f, -kGravity});
  prediction_.begin_map(false);
}

/// From landmarks; without enough of them, by prediction; without one, from the last keyframe.
template <class P>
void NextFrontEnd<P>::locate(TrackedFrame<P>& frame, FrameReport& report) {
  std::optional<Pose<P>> pose = track_landmarks(state_, inertial_, prediction_, frame, report);
  alloc_keyframe_matches<P>(state_, frame);
  {
    const work::Arena::Frame descriptors(state_.machine.local());
    match_keyframe<P>(state_, frame);
    if (!pose) pose = pose_by_prediction(frame, report);
    if (!pose) {
      const auto by_gyro = [&](const Mat3<P>& R) { return agrees_with_gyro(state_, inertial_, R); };
      pose = pose_from_keyframe<P>(state_, frame, by_gyro, report);
    }
  }
  if (!pose_is_plausible(state_, prediction_, *pose, frame.dt)) {
    report.source = PoseSource::Kept;
    pose = prediction_.last_reported();
  }
  frame.T_world_camera = settled(*pose);
}

/// Where it is better than the 8-point algorithm, which guesses the length of its translation: the
/// IMU measures it, and with a single keyframe any length is a guess, which waits for a parallax
/// that is worth one.
template <class P>
std::optional<Pose<P>> NextFrontEnd<P>::pose_by_prediction(const TrackedFrame<P>& frame,
                                                           FrameReport& report) {
  using I32 = typename P::I32;
  if (prediction_.imu_predicts()) {
    const auto stage = state_.machine.stage(stages::kGuided);
    report.source = PoseSource::Predicted;
    return inertial_.predicted_pose();
  }
  if (state_.graph_in_l2.keyframe_count() == I32(1) && !is_keyframe(frame, report)) {
    const auto stage = state_.machine.stage(stages::kGuided);
    report.source = PoseSource::Kept;
    return Pose<P>{prediction_.by_motion(frame).R, frame.T_world_last.t};
  }
  return std::nullopt;
}

/// The frame's pose, as a rotation that is one; at rest, the one of the frame before. The IMU
/// cannot tell rest from uniform motion: from where the images disagree with rest, it is not
/// believed until the vehicle has moved.
template <class P>
Pose<P> NextFrontEnd<P>::settled(const Pose<P>& T_world_camera) {
  using F = typename P::F32;
  const RestOptions& limits = state_.profile.rest;
  const auto stage = state_.machine.stage(stages::kGuided);
  const Pose<P> now{orthonormalised<P>(T_world_camera.R), T_world_camera.t};
  const Pose<P> last = prediction_.last_reported();
  const Vec3<P> moved = now.t - last.t;
  const auto& turn = (transpose(last.R) * now.R).m;
  // The trace is 1 + 2 cos(angle).
  const bool near =
      dot(moved, moved) < F(limits.position * limits.position) &&
      F(3.0f) - (turn[0][0] + turn[1][1] + turn[2][2]) < F(limits.rotation * limits.rotation);
  const bool rests = inertial_.rest().has_value();
  may_rest_ = !rests || (may_rest_ && near);
  return rests && may_rest_ ? last : now;
}

/// It has moved far enough, less far if it sees few landmarks, or can hardly be matched with the
/// last one any more.
template <class P>
bool NextFrontEnd<P>::is_keyframe(const Frame<P>& frame, const FrameReport& report) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const auto stage = state_.machine.stage(stages::kKeyframeSelection);
  const Profile& profile = state_.profile;
  const RecoveryOptions& recovery = profile.recovery;
  const int matches = frame.matches.list.count;
  if (inertial_.rest() || frame.features.list.count < recovery.min_features) return false;
  if (matches < profile.min_frame_matches) return true;
  if (report.source == PoseSource::Kept) return false;  // its place is not known
  const F sum = total_parallax(state_, inertial_, frame);
  float parallax = profile.keyframe_parallax;
  const bool lost = report.source == PoseSource::Predicted;
  // Without a map, noise would look like motion.
  if ((lost || report.inliers < recovery.min_tracked) &&
      state_.graph_in_l2.keyframe_count() > I32(1))
    parallax *= recovery.min_parallax;
  return bool(sum > F(parallax * static_cast<float>(matches)));
}

template class NextFrontEnd<work::Native>;
template class NextFrontEnd<work::Counting>;

}  // namespace leviosim::vio
