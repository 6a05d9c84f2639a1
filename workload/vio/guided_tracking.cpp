// Tracking by prediction: where the camera must be by now tells where to look for landmarks, and
// the pose is refined to all that are found. EPnP RANSAC is left for recovery.
#include "workload/vio/front_end.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {

template <class P>
std::optional<Pose<P>> FrontEnd<P>::track(Frame& frame, FrameReport& report) {
  Pose<P> T_predicted = Pose<P>::identity();
  {
    const auto stage = machine_.stage(stages::kGuided);
    frame.T_world_last = last_pose();
    T_predicted = imu_predicts() ? predicted_pose() : pose_by_motion(frame);
  }
  if (work::value(graph_.landmark_count()) == 0) return std::nullopt;
  const RefinementOptions& refinement = profile_.refinement;
  const RecoveryOptions& recovery = profile_.recovery;
  const LandmarkSearch near{profile_.guided.radius_px, refinement.rotation, refinement.position};
  const LandmarkSearch wide{recovery.wide_radius_px, recovery.rotation, recovery.position};
  if (const auto pose = search_landmarks(frame, T_predicted, near, report)) return pose;
  if (recovery.wide_radius_px > 0)
    if (const auto pose = search_landmarks(frame, T_predicted, wide, report)) return pose;
  // Lost: look for all landmarks in all of the image, then again around where EPnP puts them, which
  // is no prediction.
  for (int i : P::range(0, frame.features.list.count))
    frame.features.landmarks[i] = work::narrow<U16>(I32(kNoLandmark));
  const std::optional<Pose<P>> recovered = pose_from_landmarks(frame, report);
  if (!recovered || report.source != PoseSource::Epnp) return recovered;
  const auto pose = search_landmarks(frame, *recovered, {near.radius_px, 1.0f, 1.0f}, report);
  return pose ? pose : recovered;
}

/// The pose refined to the landmarks found around where T_predicted (T_world_camera) puts them, if
/// enough agree with it; then the features know their landmarks.
template <class P>
std::optional<Pose<P>> FrontEnd<P>::search_landmarks(Frame& frame, const Pose<P>& T_predicted,
                                                     const LandmarkSearch& search,
                                                     FrameReport& report) {
  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  const FeatureList<P>& features = frame.features.list;
  const int landmarks = work::value(graph_.landmark_count());
  const auto points = local.alloc<Span<F>>("landmark points", 3 * landmarks);
  MatchList<P> matches = alloc_matches<P>(local, features.capacity, "world matches");
  const Pose<P> T_camera_world = inverse(T_predicted);
  {
    const auto stage = machine_.stage(stages::kGuided);
    const work::Arena::Frame descriptions(local);
    const auto descriptors =
        local.alloc<Span<typename P::U32>>("landmark descriptors", kDescriptorWords * landmarks);
    const auto ages = local.alloc<Span<Byte>>("landmark ages", landmarks);
    machine_.copy_in(descriptors, graph_.descriptors);
    machine_.copy_in(points, graph_.points);
    machine_.copy_in(ages, graph_.ages);
    const GuidedInput<P> input{
        points,         descriptors, ages,       landmarks,   profile_.max_landmark_age,
        T_camera_world, rig_.camera, rig_.width, rig_.height, profile_.extractor.subpixel_steps};
    GuidedOptions options = profile_.guided;
    options.radius_px = search.radius_px;
    match_guided<P>(machine_, input, features, options, matches);
  }
  report.world_matches = matches.count;
  if (matches.count < profile_.min_world_matches) return std::nullopt;

  const auto stage = machine_.stage(stages::kRefinement);
  const auto matched_points = local.alloc<Span<F>>("matched points", 3 * matches.count);
  const auto pixels = local.alloc<Span<F>>("matched pixels", 2 * matches.count);
  const auto inliers = local.alloc<Span<Byte>>("inlier mask", matches.count);
  machine_.fork("gather", [&](work::Core& core) {
    const auto [begin, end] = core.share(matches.count);
    for (int i : P::range(begin, end)) {
      const I32 at = I32(matches.reference[i]) * I32(3);
      for (int c = 0; c < 3; ++c) matched_points[3 * i + c] = F(points[I32(at + I32(c))]);
      const I32 feature = matches.query[i];
      pixels[2 * i] = pixel(features.x[feature]);
      pixels[2 * i + 1] = pixel(features.y[feature]);
    }
  });
  RefinementOptions options = profile_.refinement;
  options.rotation = search.rotation;
  options.position = search.position;
  const RefinedPose<P> refined =
      refine_pose<P>(machine_, {matched_points, pixels, matches.count, rig_.camera}, T_camera_world,
                     options, inliers);
  report.inliers = refined.inliers;
  const float agreeing = options.min_share * static_cast<float>(matches.count);
  if (!refined.ok || refined.inliers < profile_.min_epnp_inliers ||
      static_cast<float>(refined.inliers) < agreeing)
    return std::nullopt;
  report.source = PoseSource::Tracked;
  for (int i : P::range(0, features.count))
    frame.features.landmarks[i] = work::narrow<U16>(I32(kNoLandmark));
  for (int i : P::range(0, matches.count)) {
    if (I32(inliers[i]) == I32(0)) continue;
    frame.features.landmarks[I32(matches.query[i])] = work::narrow<U16>(I32(matches.reference[i]));
  }
  return inverse(refined.T_camera_world);
}

/// Where the last frame was, in the map as it is now. A product with an inverse, which for a
/// rotation is its transpose, triples what keeps it from being a rotation: without the correction a
/// second at rest, where one such pose follows from the other, is enough to lose it.
template <class P>
Pose<P> FrontEnd<P>::last_pose() const {
  const Pose<P> T = graph_in_l2_.keyframe(graph_in_l2_.newest_keyframe()).T_world_camera *
                    motion_.T_keyframe_camera();
  return {orthonormalised<P>(T.R), T.t};
}

template <class P>
bool FrontEnd<P>::window_is_full() const {
  return bool(graph_in_l2_.keyframe_count() == I32(graph_.capacity.keyframes));
}

/// Whether the newest keyframe's velocity is known, at rest or from a window full of keyframes, and
/// recent enough to carry the prediction: velocities are good to some cm/s. Differences of two
/// frames' positions, the alternative, have the noise of both and feed it back; where there are
/// none it is the IMU or nothing.
template <class P>
bool FrontEnd<P>::imu_predicts() const {
  const float longest = lost_ ? profile_.recovery.max_blind_time : profile_.max_translation_time;
  return profile_.optimiser.joint && time_since_keyframe_ < longest &&
         (velocity_known_ || window_is_full());
}

/// The last frame's pose, turned as the gyro says and moved on at its velocity.
template <class P>
Pose<P> FrontEnd<P>::pose_by_motion(const Frame& frame) {
  const Pose<P>& last = frame.T_world_last;
  const Vec3<P> moved = last.R * (motion_.velocity() * F(frame.dt));
  if (!profile_.use_imu) return {last.R, last.t + moved};
  const Mat3<P> turn = transpose(motion_.gyro_rotation()) * motion_since_keyframe().R;
  return {last.R * turn, last.t + moved};
}

/// Leaves the motion over this frame for the next one.
template <class P>
void FrontEnd<P>::remember_motion(const Frame& frame, bool keyframe, bool lost) {
  const auto stage = machine_.stage(stages::kGuided);
  lost_ = lost;
  const Pose<P>& T = frame.T_world_camera;
  const Pose<P> T_world_keyframe =
      graph_in_l2_.keyframe(graph_in_l2_.newest_keyframe()).T_world_camera;
  Vec3<P> velocity{0.0f, 0.0f, 0.0f};
  if (frame.dt > 0.0f && frame_number_ > 1)
    velocity = transpose(T.R) * ((T.t - frame.T_world_last.t) * F(1.0f / frame.dt));
  const Mat3<P> turned = keyframe ? Mat3<P>::identity() : motion_since_keyframe().R;
  motion_.store(inverse(T_world_keyframe) * T, velocity, turned, T);
}

/// Whether the map has a meaning. The comparisons are not true either of what is not a number.
template <class P>
bool FrontEnd<P>::map_is_plausible() {
  const auto stage = machine_.stage(stages::kGuided);
  const RecoveryOptions& limits = profile_.recovery;
  const KeyframeState<P> last = graph_in_l2_.keyframe(graph_in_l2_.newest_keyframe());
  const ImuBias<P> bias = graph_in_l2_.bias();
  const auto below = [](const Vec3<P>& v, float limit) { return dot(v, v) < F(limit * limit); };
  return below(last.velocity, limits.max_speed) && below(bias.gyro, limits.max_gyro_bias) &&
         below(bias.accel, limits.max_accel_bias) &&
         is_plausible(last.T_world_camera, time_since_keyframe_);
}

/// The frame's pose, as a rotation that is one; at rest, the one of the frame before. The IMU
/// cannot tell rest from uniform motion: from where the images disagree with rest, it is not
/// believed until the vehicle has moved.
template <class P>
Pose<P> FrontEnd<P>::settled(const Pose<P>& T_world_camera) {
  constexpr float kFarthest = 0.05f;  // that the noise of a frame puts a camera at rest [m]
  constexpr float kTurned = 0.02f;    // likewise, rad
  const auto stage = machine_.stage(stages::kGuided);
  const Pose<P> now{orthonormalised<P>(T_world_camera.R), T_world_camera.t};
  const Pose<P> last = motion_.T_world_camera();
  const Vec3<P> moved = now.t - last.t;
  const auto& turn = (transpose(last.R) * now.R).m;
  // The trace is 1 + 2 cos(angle).
  const bool near = dot(moved, moved) < F(kFarthest * kFarthest) &&
                    F(3.0f) - (turn[0][0] + turn[1][1] + turn[2][2]) < F(kTurned * kTurned);
  may_rest_ = !rest_ || (may_rest_ && near);
  return rest_ && may_rest_ ? last : now;
}

/// Whether T_world_camera is a pose to which the camera can have got from where it was reported
/// last.
/// @param seconds  that this took at most
template <class P>
bool FrontEnd<P>::is_plausible(const Pose<P>& T_world_camera, float seconds) const {
  constexpr float kCorrection = 1;  // that the optimiser may have made meanwhile, m
  const Vec3<P> moved = T_world_camera.t - motion_.T_world_camera().t;
  const float limit = profile_.recovery.max_speed * seconds + kCorrection;
  const Mat3<P>& R = T_world_camera.R;
  const F size = dot(R.row(0), R.row(0)) + dot(R.row(1), R.row(1)) + dot(R.row(2), R.row(2));
  return dot(moved, moved) < F(limit * limit) && size > F(2.9f) && size < F(3.1f);
}

template class FrontEnd<work::Native>;
template class FrontEnd<work::Counting>;

}  // namespace leviosim::vio
