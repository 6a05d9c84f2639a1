#include "workload/next/next_front_end.h"

#include <utility>

#include "workload/next/feature_alignment.h"
#include "workload/next/guided_tracking.h"
#include "workload/next/motion_record.h"
#include "workload/next/plausibility.h"
#include "workload/vio/frame.h"
#include "workload/vio/keyframe_matching.h"
#include "workload/vio/keyframe_pose.h"
#include "workload/vio/keyframes.h"
#include "workload/vio/map_start.h"
#include "workload/vio/parallax.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {

template <class P>
NextFrontEnd<P>::NextFrontEnd(const Profile& profile, const Rig& rig, work::Machine& cluster,
                              work::Arena& keyframe_memory, work::Arena& loop_memory,
                              const PoseGraph<P>& graph, MapStatus& map)
    : state_(profile, rig, cluster, keyframe_memory, graph),
      map_(map),
      inertial_(state_),
      prediction_(state_, inertial_, map_, keyframe_memory),
      random_(profile.sampling_seed),
      fixed_(state_, inertial_, keyframe_memory),
      own_motion_(state_, inertial_, keyframe_memory),
      path_(state_, inertial_, keyframe_memory, profile.frames_that_wait(rig.frame_rate)) {
  if (profile.loop.enabled) loop_.emplace(state_, loop_memory);
}

template <class P>
FrameReport NextFrontEnd<P>::process(const FrameInput& input) {
  const work::EitherFrame memory(state_.machine);
  FrameReport report;
  if (input.wants_features) report.seen.emplace();
  TrackedFrame<P> frame;
  frame.dt = input.dt;
  take_image(input, state_);
  inertial_.integrate(input);
  extract_frame<P>(state_, frame);
  if (repeats_last(frame) && !inertial_.rest()) frame.features.list.count = 0;
  report.keyframe = true;
  still_ = rests_ = false;
  if (std::exchange(waited_, false) && !initialises()) prediction_.follow_alignment();
  correct_path(input.dt, report);
  path_.take_motion(input.dt);
  if (state_.started) look_for_motion(frame);
  frame.matches.list.count = 0;  // their memory is free again
  if (!state_.started) {
    start_map<P>(state_, frame);
  } else if (began_in_motion()) {
    start_anew(frame);
  } else if (starts_at_rest()) {
    come_to_rest(frame, report, *inertial_.rest());
  } else if (!map_is_plausible(state_, prediction_, !initialises())) {
    start_anew(frame);
    report.map_restarts = 1;
    if (loop_) loop_->expect_another_map();
  } else {
    if (initialises())
      follow(frame, report);
    else
      locate(frame, report);
    if (images_rest()) {
      report.source = PoseSource::First;
      come_to_rest(frame, report, inertial_.recent());
    } else {
      report.keyframe = is_keyframe(frame, report);
      if (loop_ && !initialises()) loop_->follow(frame, report);
      if (report.keyframe) insert_keyframe<P>(state_, frame, any_depth());
    }
  }
  own_motion_.end_frame(report.keyframe);
  if (initialises() || !path_.empty()) path_.remember();
  prediction_.remember(frame, report);
  if (initialises())
    if (const std::optional<Vec3<P>> held = held_position()) frame.T_world_camera.t = *held;
  complete<P>(state_, frame, report);
  waited_ = initialises();
  if (waited_) report.state = static_cast<int>(PoseState::Initialising);
  if (inertial_.rest() || images_rest()) report.at_rest = 1;
  rested_ = report.source == PoseSource::First;
  if (loop_) loop_->correct(frame, frame.dt, report);
  return report;
}

/// Whether the features are those of the frame before, to the last bit, which noise does not allow
/// two images to show: the camera has sent the same one again. At rest that does no harm.
template <class P>
bool NextFrontEnd<P>::repeats_last(const Frame<P>& frame) {
  using U32 = typename P::U32;
  const auto stage = state_.machine.stage(stages::kGuided);
  const FeatureList<P>& list = frame.features.list;
  U32 sum = 0u;
  for (int i : P::range(0, list.count * kDescriptorWords)) sum += list.descriptors[i];
  const bool repeats = list.count > 0 && bool(sum == sum_);
  sum_ = sum;
  return repeats;
}

/// Whether the window is to begin with this frame, since the vehicle stands still.
template <class P>
bool NextFrontEnd<P>::starts_at_rest() const {
  return inertial_.rest() && (initialises() || !prediction_.window_is_full());
}

/// An even flight looks like rest to the IMU: before a window begins at rest, the image is compared
/// with the keyframe, which is the frame before, or less than a second old. From where it moves,
/// the IMU is not believed.
template <class P>
void NextFrontEnd<P>::look_for_motion(TrackedFrame<P>& frame) {
  using F = typename P::F32;
  const RestOptions& limits = state_.profile.rest;
  const auto within = [](const Vec3<P>& motion, float most) {
    return bool(dot(motion, motion) < F(most * most));
  };
  if (!inertial_.rest() && !inertial_.rest_is_rejected()) rest_ = {};
  if (!starts_at_rest() || state_.time_since_keyframe > limits.image_time) return;
  const work::EitherFrame memory(state_.machine);
  match_last_keyframe(frame);
  align_features<P>(state_, frame, std::nullopt);
  const auto stage = state_.machine.stage(stages::kGuided);
  const auto motion = [&](float most) {
    return motion_over_distance(state_, frame, Mat3<P>::identity(), most);
  };
  const float dt = state_.time_since_keyframe;
  rest_.time += dt;
  if (const std::optional<Vec3<P>> moved = motion(limits.wrong_match)) {
    rest_.motion = rest_.motion * F(std::max(0.0f, 1 - dt / limits.image_time)) + *moved;
    const float share = std::min(1.0f, rest_.time / limits.image_time);
    if (share >= limits.seen_share && within(rest_.motion, share * limits.image_motion))
      rest_.was_seen = true;
    if (within(rest_.motion, limits.image_motion)) return;
  } else if (!motion(limits.fast_match)) {
    return;
  }
  inertial_.reject_rest();
}

/// Whether the map began at a rest that the images never showed: its velocity and biases are wrong.
template <class P>
bool NextFrontEnd<P>::began_in_motion() const {
  return inertial_.rest_is_rejected() && !rest_.was_seen && !initialises() && has_one_keyframe();
}

template <class P>
bool NextFrontEnd<P>::has_one_keyframe() const {
  using I32 = typename P::I32;
  return bool(state_.graph_in_l2.keyframe_count() == I32(1));
}

/// Room for the matches lasts as long as the caller's.
template <class P>
void NextFrontEnd<P>::match_last_keyframe(TrackedFrame<P>& frame) {
  alloc_keyframe_matches<P>(state_, frame);
  const work::Arena::Frame descriptors(state_.machine.local());
  match_keyframe<P>(state_, frame);
}

/// Rest tells nothing of how far a map came that is not aligned: the vehicle is where it was
/// reported, and what was reported before it stays a guess.
template <class P>
void NextFrontEnd<P>::come_to_rest(TrackedFrame<P>& frame, FrameReport& report,
                                   const Stillness<P>& rest) {
  std::optional<Vec3<P>> held;
  if (initialises()) {
    report.earlier.clear();
    held = held_position();
  }
  start_at_rest(frame, rest, held);
}

/// A vehicle that stands still before the first window is full starts anew with every frame, from
/// where the last one was: at rest, gravity and the gyro's bias can be read off and the velocity is
/// zero, while noise alone would sooner or later look like parallax, and the scale of a map with
/// few keyframes is a guess.
template <class P>
void NextFrontEnd<P>::start_at_rest(TrackedFrame<P>& frame, const Stillness<P>& rest,
                                    const std::optional<Vec3<P>>& held) {
  work::Arena& local = state_.machine.local();
  const work::Arena::Frame memory(local);
  const auto stage = state_.machine.stage(stages::kTriangulation);
  const auto record = local.alloc<Floats>("IMU interval", Preintegration<P>::kFloats);
  frame.T_world_camera = prediction_.last_pose();
  if (held) frame.T_world_camera.t = *held;
  frame.T_world_last = frame.T_world_camera;
  Mat3<P>& R = frame.T_world_camera.R;
  R = levelled<P>(R, rest.accel_mean);
  begin_map<P>(state_, frame, record, {rest.gyro_mean, {0.0f, 0.0f, 0.0f}},
               {0.0f, 0.0f, -kGravity});
  BiasPrior<P> prior = state_.graph_in_l2.bias_prior();
  const float stddev = state_.profile.optimiser.prior.rest_gyro_bias;
  prior.gyro_information = 1.0f / (stddev * stddev);
  state_.graph_in_l2.set_bias_prior(prior);
  map_.aligned = true;
  map_.fit = {};
  path_.clear();  // what was reported is where it stands
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
  const Vec3<P>& force = inertial_.recent().accel_mean;
  if (dot(force, force) > F(0.0f)) R = levelled<P>(R, force);
  begin_map<P>(state_, frame, record, ImuBias<P>::zero(), {0.0f, 0.0f, -kGravity});
  map_ = {};
}

/// Of landmarks that are new while the map waits for its alignment, m; else 0.
template <class P>
float NextFrontEnd<P>::any_depth() const {
  if (!initialises()) return 0;
  return 1 / (map_.inverse_depth > 0 ? map_.inverse_depth : state_.profile.alignment.inverse_depth);
}

/// Whether the map waits for its alignment.
template <class P>
bool NextFrontEnd<P>::initialises() const {
  return state_.profile.initialises() && !map_.aligned;
}

/// From where on the map tells how far the camera has gone, all poses since images were first seen
/// in motion are corrected with every frame, until an aligned map has settled.
template <class P>
void NextFrontEnd<P>::correct_path(float dt, FrameReport& report) {
  if (initialises() && !map_.converged) return;
  report.earlier = path_.poses(dt);
  settling_ = initialises() ? 0 : settling_ + dt;
  if (settling_ > state_.profile.settling_time) path_.clear();
}

/// While no alignment of more than few keyframes has converged, its scale is a guess, and so is how
/// far the camera has gone: it is reported where the map began. The map itself keeps the guess.
template <class P>
std::optional<Vec3<P>> NextFrontEnd<P>::held_position() const {
  const auto stage = state_.machine.stage(stages::kGuided);
  const auto& graph = state_.graph_in_l2;
  if (map_.converged) return std::nullopt;
  return graph.keyframe(graph.keyframe_slot(0)).T_world_camera.t;
}

/// Landmarks without a distance tell no pose: the IMU moves the last keyframe on, as far as its
/// velocity is known by now, while features are followed from keyframe to keyframe.
template <class P>
void NextFrontEnd<P>::follow(TrackedFrame<P>& frame, FrameReport& report) {
  frame.T_world_last = prediction_.last_pose();
  match_last_keyframe(frame);
  align_features<P>(state_, frame, std::nullopt);
  fixed_.drop_from(frame);
  own_motion_.drop_from(frame);
  report.source = PoseSource::Initialising;
  {
    const auto stage = state_.machine.stage(stages::kGuided);
    const std::optional<Pose<P>> still = still_pose(frame);
    frame.T_world_camera = still ? *still : inertial_.predicted_pose();
  }
  frame.T_world_camera = held_at_rest(frame.T_world_camera);
}

/// From landmarks; without enough of them, by prediction; without one, from the last keyframe.
template <class P>
void NextFrontEnd<P>::locate(TrackedFrame<P>& frame, FrameReport& report) {
  match_last_keyframe(frame);
  Pose<P> T_predicted = Pose<P>::identity();
  {
    const auto stage = state_.machine.stage(stages::kGuided);
    frame.T_world_last = prediction_.last_pose();
    T_predicted = prediction_.of(frame);
  }
  align_features<P>(state_, frame, T_predicted);
  fixed_.drop_from(frame);
  own_motion_.drop_from(frame);
  std::optional<Pose<P>> pose =
      track_landmarks(state_, inertial_, random_, T_predicted, frame, report);
  if (!pose) pose = pose_by_prediction(frame, report);
  if (!pose) {
    const auto by_gyro = [&](const Mat3<P>& R) { return agrees_with_gyro(state_, inertial_, R); };
    pose = pose_from_keyframe<P>(state_, random_, frame, by_gyro, report);
  }
  if (!pose_is_plausible(state_, prediction_, *pose, frame.dt)) {
    report.source = PoseSource::Kept;
    pose = prediction_.last_reported();
  }
  frame.T_world_camera = held_at_rest(*pose);
}

/// A vehicle that rested at the only keyframe, and has not moved in any image since, still rests
/// there, though the IMU feels idling rotors: they lead nowhere. Else by the IMU, which measures
/// the length of the translation, where the 8-point algorithm guesses it. With a single keyframe
/// any length is a guess, which waits for a parallax that is worth one.
template <class P>
std::optional<Pose<P>> NextFrontEnd<P>::pose_by_prediction(const TrackedFrame<P>& frame,
                                                           FrameReport& report) {
  const bool one_keyframe = has_one_keyframe(), by_imu = prediction_.imu_predicts();
  if (one_keyframe) {
    const auto stage = state_.machine.stage(stages::kGuided);
    const std::optional<Pose<P>> still = still_pose(frame);
    const bool rests = rested_ && rests_ && within_noise(inertial_.predicted_pose(), *still);
    report.at_rest = rests ? 1 : 0;
    report.source = rests ? PoseSource::First : PoseSource::Predicted;
    if (still && (rests || by_imu)) return still;
  }
  if (by_imu) {
    const auto stage = state_.machine.stage(stages::kGuided);
    report.source = PoseSource::Predicted;
    return inertial_.predicted_pose();
  }
  if (one_keyframe && !is_keyframe(frame, report)) {
    const auto stage = state_.machine.stage(stages::kGuided);
    report.source = PoseSource::Kept;
    return Pose<P>{prediction_.by_motion(frame).R, frame.T_world_last.t};
  }
  return std::nullopt;
}

/// The pose of a camera of which the images say that it is where it was at the last keyframe,
/// turned at most. What does not move in the image at all has not even turned, whatever the gyro
/// says, whose bias need not be known yet. Works inside a stage.
template <class P>
std::optional<Pose<P>> NextFrontEnd<P>::still_pose(const Frame<P>& frame) {
  using F = typename P::F32;
  const RestOptions& limits = state_.profile.rest;
  const auto is_still = [&](const Mat3<P>& R_camera_keyframe) {
    const auto moved = motion_over_distance(state_, frame, R_camera_keyframe, limits.wrong_match);
    return moved && bool(dot(*moved, *moved) < F(limits.image_motion * limits.image_motion));
  };
  const Pose<P> keyframe = state_.newest_keyframe().T_world_camera;
  const Mat3<P> turn = inertial_.motion_since_keyframe().R;
  rests_ = is_still(Mat3<P>::identity());
  still_ = rests_ || is_still(transpose(turn));
  if (!still_) return std::nullopt;
  return rests_ ? keyframe : Pose<P>{keyframe.R * turn, keyframe.t};
}

/// Whether the images have shown rest for as long as the IMU must. It may see rotors that idle, but
/// no turns, and must feel gravity.
template <class P>
bool NextFrontEnd<P>::images_rest() const {
  const RestOptions& limits = state_.profile.rest;
  return rests_ && state_.time_since_keyframe > limits.image_time &&
         work::value(inertial_.recent().gyro_variance) < limits.gyro_stddev * limits.gyro_stddev &&
         inertial_.recent_may_be_rest();
}

/// Whether a vehicle at rest may seem to have moved so far. Works inside a stage.
template <class P>
bool NextFrontEnd<P>::within_noise(const Pose<P>& now, const Pose<P>& last) const {
  using F = typename P::F32;
  const RestOptions& limits = state_.profile.rest;
  const Vec3<P> moved = now.t - last.t;
  const auto& turn = (transpose(last.R) * now.R).m;
  // The trace is 1 + 2 cos(angle).
  return dot(moved, moved) < F(limits.position * limits.position) &&
         F(3.0f) - (turn[0][0] + turn[1][1] + turn[2][2]) < F(limits.rotation * limits.rotation);
}

/// The frame's pose with an orthonormal rotation; at rest, the pose of the frame before. The IMU
/// cannot tell rest from uniform motion: once the images contradict rest, rest is ignored until the
/// IMU has measured motion.
template <class P>
Pose<P> NextFrontEnd<P>::held_at_rest(const Pose<P>& T_world_camera) {
  const auto stage = state_.machine.stage(stages::kGuided);
  const Pose<P> now{orthonormalised<P>(T_world_camera.R), T_world_camera.t};
  const Pose<P> last = prediction_.last_reported();
  const bool near = within_noise(now, last);
  if (inertial_.rest() && !near) inertial_.reject_rest();
  return inertial_.rest() ? last : now;
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
  if (initialises())
    return !still_ &&
           (state_.time_since_keyframe > profile.alignment_interval ||
            bool(sum > F(profile.alignment_parallax * parallax * static_cast<float>(matches))));
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
