#include "workload/vio/front_end.h"

#include <cstring>

#include "workload/geometry/recover_pose.h"
#include "workload/vio/stages.h"
#include "workload/vision/strip_extractor.h"

namespace leviosim::vio {
namespace {

template <class P>
Mat3<P> matrix_from(const std::array<float, 9>& a) {
  return {{{a[0], a[1], a[2]}, {a[3], a[4], a[5]}, {a[6], a[7], a[8]}}};
}

/// The camera in units of 1/steps px.
PinholeCamera finer(const PinholeCamera& c, int steps) {
  const float s = static_cast<float>(steps);
  return {s * c.fx, s * c.fy, s * c.cx, s * c.cy};
}

/// Whether the image, its blurred copy and the features exceed the local memory.
template <class P>
bool needs_strips(const ExtractorOptions& options, const Rig& rig, const work::Machine& machine) {
  const Bytes features = observed_features_size<P>(options.max_features(rig.width, rig.height));
  return features + options.memory_of_whole_image(rig.width, rig.height, machine.cores()) >
         machine.local().capacity();
}

/// Host-side: the pose as plain numbers.
template <class P>
void report_pose(const Pose<P>& T_world_camera, FrameReport& report) {
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      report.R_world_camera[3 * r + c] = work::value(T_world_camera.R.m[r][c]);
  report.p_world_camera = {work::value(T_world_camera.t.x), work::value(T_world_camera.t.y),
                           work::value(T_world_camera.t.z)};
}

}  // namespace

template <class P>
FrontEnd<P>::FrontEnd(const Profile& profile, const Rig& rig, work::Machine& cluster,
                      work::Arena& keyframe_memory, const PoseGraph<P>& graph)
    : profile_(profile),
      rig_(rig),
      inverse_camera_matrix_(
          CameraMatrix<P>::inverse_of(finer(rig.camera, profile.extractor.subpixel_steps))),
      R_camera_body_(matrix_from<P>(rig.R_camera_body)),
      machine_(cluster),
      strips_(needs_strips<P>(profile.extractor, rig, cluster)),
      keyframe_(keyframe_memory, profile.extractor.max_features(rig.width, rig.height), rig.width,
                rig.height, strips_),
      graph_(graph),
      graph_in_l2_(seen_from_cluster<P>(graph)),
      stillness_(StillnessOptions{}, keyframe_.stillness) {
  if (profile.guided.enabled) motion_ = MotionRecord<P>(keyframe_memory);
}

template <class P>
FrameReport FrontEnd<P>::process(const FrameInput& input) {
  const work::Arena::Frame memory(machine_.local());
  std::memcpy(static_cast<void*>(keyframe_.image.pixels.data()), input.pixels,
              static_cast<std::size_t>(input.width * input.height));  // by the camera interface
  ++frame_number_;
  time_since_keyframe_ += input.dt;
  FrameReport report;
  Frame frame;
  frame.dt = input.dt;
  integrate_imu(input);
  extract(frame);
  if (!started_) {
    start(frame);
    report.keyframe = true;
  } else if (profile_.guided.enabled && rest_ && !window_is_full()) {
    start_at_rest(frame);
    report.keyframe = true;
  } else if (profile_.guided.enabled && !map_is_plausible()) {
    start_anew(frame);
    report.keyframe = true;
  } else {
    std::optional<Pose<P>> pose =
        profile_.guided.enabled ? track(frame, report) : pose_from_landmarks(frame, report);
    alloc_keyframe_matches(frame);
    {
      // The keyframe's descriptors stay until the pose is known (paper, memory table: 8-point).
      const work::Arena::Frame descriptors(machine_.local());
      match_keyframe(frame);
      // The 8-point algorithm guesses the length of its translation; the IMU measures it.
      if (!pose && profile_.guided.enabled && imu_predicts()) {
        const auto stage = machine_.stage(stages::kGuided);
        report.source = PoseSource::Predicted;
        pose = predicted_pose();
      }
      // With a single keyframe any length is a guess: it waits for a parallax that is worth one.
      if (!pose && profile_.guided.enabled && graph_in_l2_.keyframe_count() == I32(1) &&
          !is_keyframe(frame, report)) {
        const auto stage = machine_.stage(stages::kGuided);
        report.source = PoseSource::Kept;
        pose = Pose<P>{pose_by_motion(frame).R, frame.T_world_last.t};
      }
      if (!pose) pose = pose_from_keyframe(frame, report);
    }
    if (profile_.guided.enabled && !is_plausible(*pose, input.dt)) {
      report.source = PoseSource::Kept;
      pose = motion_.T_world_camera();
    }
    frame.T_world_camera = profile_.guided.enabled ? settled(*pose) : *pose;
    report.keyframe = is_keyframe(frame, report);
    if (report.keyframe) insert_keyframe(frame);
  }
  if (profile_.guided.enabled)
    remember_motion(frame, report.keyframe, report.source == PoseSource::Predicted);
  report.features = frame.features.list.count;
  report.frame_matches = frame.keyframe_matches.count;
  report.landmarks = work::value(graph_.landmark_count());
  report_pose<P>(frame.T_world_camera, report);
  return report;
}

template <class P>
void FrontEnd<P>::extract(Frame& frame) {
  const auto stage = machine_.stage(stages::kExtraction);
  const int capacity = keyframe_.features.list.capacity;
  frame.features = alloc_observed_features<P>(machine_.local(), capacity);
  if (strips_)
    extract_features_in_strips<P>(machine_, keyframe_.image, keyframe_.blurred, profile_.extractor,
                                  frame.features.list);
  else
    extract_features<P>(machine_, keyframe_.image, profile_.extractor, frame.features.list);
  for (int i : P::range(0, frame.features.list.count))
    frame.features.landmarks[i] = work::narrow<U16>(I32(kNoLandmark));
}

template <class P>
std::optional<Pose<P>> FrontEnd<P>::pose_from_landmarks(Frame& frame, FrameReport& report) {
  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  const int landmarks = work::value(graph_.landmark_count());
  const int capacity = graph_.capacity.landmarks;
  Span<F> points;
  MatchList<P> matches;
  {
    const auto stage = machine_.stage(stages::kWorldMatching);
    const auto descriptors =
        local.alloc<Span<typename P::U32>>("landmark descriptors", kDescriptorWords * capacity);
    points = local.alloc<Span<F>>("landmark points", 3 * capacity);
    const auto ages = local.alloc<Span<Byte>>("landmark ages", capacity);
    matches = alloc_matches<P>(local, frame.features.list.capacity, "world matches");
    machine_.copy_in(descriptors.subspan(0, kDescriptorWords * landmarks), graph_.descriptors);
    machine_.copy_in(points.subspan(0, 3 * landmarks), graph_.points);
    machine_.copy_in(ages.subspan(0, landmarks), graph_.ages);
    match_two_way<P>(machine_, frame.features.list.descriptors, frame.features.list.count,
                     descriptors, landmarks, profile_.matcher, matches);
    const int before_filter = matches.count;
    int kept = 0;
    for (int i : P::range(0, matches.count)) {
      const I32 landmark = matches.reference[i];
      const I32 age = ages[landmark];
      if (age > I32(profile_.max_landmark_age)) continue;
      matches.query[kept] = work::narrow<U16>(I32(matches.query[i]));
      matches.reference[kept] = work::narrow<U16>(landmark);
      frame.features.landmarks[I32(matches.query[kept])] = work::narrow<U16>(landmark);
      ++kept;
    }
    matches.count = kept;
    report.world_matches = kept;
    if (before_filter < profile_.min_world_matches) return std::nullopt;
  }
  if (!profile_.use_epnp || matches.count < profile_.min_world_matches) return std::nullopt;

  const auto stage = machine_.stage(stages::kEpnp);
  const auto matched_points = local.alloc<Span<F>>("matched points", 3 * matches.count);
  const auto pixels = local.alloc<Span<F>>("matched pixels", 2 * matches.count);
  for (int i : P::range(0, matches.count)) {
    const I32 at = I32(matches.reference[i]) * I32(3);
    for (int c = 0; c < 3; ++c) matched_points[3 * i + c] = F(points[I32(at + I32(c))]);
    const I32 feature = matches.query[i];
    pixels[2 * i] = pixel(frame.features.list.x[feature]);
    pixels[2 * i + 1] = pixel(frame.features.list.y[feature]);
  }
  PnpOptions options = profile_.pnp;
  options.seed += frame_number_;
  const PnpResult<P> result = estimate_pose_epnp<P>(
      machine_, {matched_points, pixels, matches.count, rig_.camera}, options);
  report.inliers = result.inliers;
  const bool supported = result.ok && result.inliers >= profile_.min_epnp_inliers;
  report.source = supported ? PoseSource::Epnp : PoseSource::Predicted;
  return supported ? inverse(result.T_camera_world) : predicted_pose();
}

template <class P>
void FrontEnd<P>::alloc_keyframe_matches(Frame& frame) {
  work::Arena& local = machine_.local();
  const ObservedFeatures<P>& old = keyframe_.features;
  frame.keyframe_matches = alloc_matches<P>(local, frame.features.list.capacity, "frame matches");
  frame.keyframe_pixels =
      local.alloc<Span<U16>>("keypoints of the keyframe", 2 * old.list.capacity);
  frame.keyframe_landmarks = local.alloc<Span<U16>>("landmarks of the keyframe", old.list.capacity);
}

/// Leaves the keyframe's descriptors in L1.
template <class P>
void FrontEnd<P>::match_keyframe(Frame& frame) {
  const auto stage = machine_.stage(stages::kFrameMatching);
  work::Arena& local = machine_.local();
  const ObservedFeatures<P>& old = keyframe_.features;
  const int n = old.list.count;
  const auto descriptors = local.alloc<Span<typename P::U32>>("descriptors of the keyframe",
                                                              kDescriptorWords * old.list.capacity);
  machine_.copy_in(descriptors.subspan(0, kDescriptorWords * n), old.list.descriptors);
  machine_.copy_in(frame.keyframe_pixels.subspan(0, n), old.list.x);
  machine_.copy_in(frame.keyframe_pixels.subspan(old.list.capacity, n), old.list.y);
  machine_.copy_in(frame.keyframe_landmarks.subspan(0, n), old.landmarks);
  match_two_way<P>(machine_, frame.features.list.descriptors, frame.features.list.count,
                   descriptors, n, profile_.matcher, frame.keyframe_matches);
}

template <class P>
Vec2<P> FrontEnd<P>::normalised(I32 u, I32 v) const {
  const Vec3<P> x = inverse_camera_matrix_ * Vec3<P>{work::to_f32(u), work::to_f32(v), 1.0f};
  return {x.x, x.y};
}

/// A coordinate of a feature in px.
template <class P>
typename P::F32 FrontEnd<P>::pixel(I32 coordinate) const {
  const int steps = profile_.extractor.subpixel_steps;
  if (steps == 1) return work::to_f32(coordinate);
  return work::to_f32(coordinate) * F(1.0f / static_cast<float>(steps));
}

/// From the essential matrix; its translation has the length that the last velocity suggests.
template <class P>
std::optional<Pose<P>> FrontEnd<P>::pose_from_keyframe(const Frame& frame, FrameReport& report) {
  const KeyframeState<P> last = graph_in_l2_.keyframe(graph_in_l2_.newest_keyframe());
  const MatchList<P>& matches = frame.keyframe_matches;
  report.source = PoseSource::Kept;
  if (matches.count < profile_.min_frame_matches) return last.T_world_camera;

  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  const auto stage = machine_.stage(stages::kEightPoint);
  const auto a = local.alloc<Span<F>>("matched points of the keyframe", 2 * matches.count);
  const auto b = local.alloc<Span<F>>("matched points", 2 * matches.count);
  const auto inliers = local.alloc<Span<Byte>>("inlier mask", matches.count);
  const int old_v = keyframe_.features.list.capacity;
  for (int i : P::range(0, matches.count)) {
    const I32 now = matches.query[i];
    const I32 old = matches.reference[i];
    const Vec2<P> in_a =
        normalised(frame.keyframe_pixels[old], frame.keyframe_pixels[I32(old + I32(old_v))]);
    const Vec2<P> in_b = normalised(frame.features.list.x[now], frame.features.list.y[now]);
    a[2 * i] = in_a.x;
    a[2 * i + 1] = in_a.y;
    b[2 * i] = in_b.x;
    b[2 * i + 1] = in_b.y;
  }
  const TwoViewMatches<P> views{a, b, matches.count};
  EssentialOptions options = profile_.essential;
  options.seed += frame_number_;
  const EssentialResult<P> essential =
      estimate_essential<P>(machine_, views, rig_.camera.fx, options, inliers);
  if (!essential.ok) return last.T_world_camera;
  const TwoViewPose<P> motion = recover_pose<P>(machine_, views, inliers, essential.E);
  if (!motion.ok) return last.T_world_camera;
  if (profile_.guided.enabled && !agrees_with_gyro(motion.T_b_a.R)) return last.T_world_camera;

  report.source = PoseSource::EightPoint;
  report.inliers = essential.inliers;
  const F dt = std::min(time_since_keyframe_, profile_.max_translation_time);
  const F length = work::max(F(norm(last.velocity) * dt), F(profile_.min_translation));
  const Pose<P> T_camera_keyframe{motion.T_b_a.R, motion.T_b_a.t * length};
  return last.T_world_camera * inverse(T_camera_keyframe);
}

/// Whether the gyro saw this rotation since the keyframe, but for the largest bias and 0.05 rad.
/// The 8-point algorithm's choice among its four solutions is wrong at times, and a map that begins
/// with one is of no use.
template <class P>
bool FrontEnd<P>::agrees_with_gyro(const Mat3<P>& R_camera_keyframe) {
  const float limit = 0.05f + profile_.optimiser.prior.gyro_bias * time_since_keyframe_;
  const auto& R = (R_camera_keyframe * motion_since_keyframe().R).m;
  // The trace is 1 + 2 cos(angle).
  return bool(F(3.0f) - (R[0][0] + R[1][1] + R[2][2]) < F(limit * limit));
}

/// A keyframe has moved far enough, or can hardly be matched with the last one any more. Parallax
/// is what remains of the motion of the matches when the rotation since the keyframe is undone: the
/// rotation that the gyro measured, for a wrong pose would look like parallax, and every frame
/// after it would become a keyframe. Only without an IMU it is that of the poses.
template <class P>
bool FrontEnd<P>::is_keyframe(const Frame& frame, const FrameReport& report) {
  work::Arena& local = machine_.local();
  const work::Arena::Frame memory(local);
  const auto stage = machine_.stage(stages::kKeyframeSelection);
  const MatchList<P>& matches = frame.keyframe_matches;
  const bool guided = profile_.guided.enabled;
  if (guided && (rest_ || frame.features.list.count < profile_.recovery.min_features)) return false;
  if (matches.count < profile_.min_frame_matches) return true;
  if (guided && report.source == PoseSource::Kept) return false;  // its place is not known
  Mat3<P> R_camera_keyframe = Mat3<P>::identity();
  if (profile_.parallax_without_rotation && profile_.use_imu) {
    R_camera_keyframe = transpose(motion_since_keyframe().R);
  } else if (profile_.parallax_without_rotation) {
    const KeyframeState<P> last = graph_in_l2_.keyframe(graph_in_l2_.newest_keyframe());
    R_camera_keyframe = transpose(frame.T_world_camera.R) * last.T_world_camera.R;
  }
  F sum = 0.0f;
  const int old_v = keyframe_.features.list.capacity;
  for (int i : P::range(0, matches.count)) {
    const I32 now = matches.query[i];
    const I32 old = matches.reference[i];
    const Vec2<P> seen = normalised(frame.features.list.x[now], frame.features.list.y[now]);
    const Vec2<P> before =
        normalised(frame.keyframe_pixels[old], frame.keyframe_pixels[I32(old + I32(old_v))]);
    const Vec3<P> turned = R_camera_keyframe * Vec3<P>{before.x, before.y, 1.0f};
    const F scale = F(1.0f) / turned.z;
    const F x = seen.x - turned.x * scale;
    const F y = seen.y - turned.y * scale;
    sum += work::sqrt(F(x * x + y * y));
  }
  float parallax = profile_.keyframe_parallax;
  const bool lost = report.source == PoseSource::Predicted;
  // Without a map, noise would look like motion.
  if (guided && (lost || report.inliers < profile_.recovery.min_tracked) &&
      graph_in_l2_.keyframe_count() > I32(1))
    parallax *= profile_.recovery.min_parallax;
  return bool(sum > F(parallax * static_cast<float>(matches.count)));
}

template class FrontEnd<work::Native>;
template class FrontEnd<work::Counting>;

}  // namespace leviosim::vio
