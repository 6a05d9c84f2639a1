#include "workload/vio/levio/two_view_pose.h"

#include <algorithm>

#include "workload/vio/levio/geometry/essential_ransac.h"
#include "workload/vio/levio/geometry/pose_matrix.h"
#include "workload/vio/levio/geometry/pose_recovery.h"
#include "workload/vio/stages.h"

namespace leviosim::vio::levio {
namespace {

/// Both views of all matches, in pixels and in normalised coordinates.
template <class P>
struct Views {
  using Floats = typename P::template Span<typename P::F32>;

  Views(work::Arena& local, int matches)
      : pixels_a(local.alloc<Floats>("keypoints of the keyframe", 2 * matches)),
        pixels_b(local.alloc<Floats>("keypoints", 2 * matches)),
        a(local.alloc<Floats>("normalised keypoints of the keyframe", 2 * matches)),
        b(local.alloc<Floats>("normalised keypoints", 2 * matches)) {}

  PixelMatches<P> pixels(int n) const { return {pixels_a, pixels_b, n}; }
  TwoViewMatches<P> normalised(int n) const { return {a, b, n}; }

  Floats pixels_a, pixels_b, a, b;
};

template <class P>
void put(typename P::template Span<typename P::F32> to, int i, typename P::F32 x,
         typename P::F32 y) {
  to[2 * i] = x;
  to[2 * i + 1] = y;
}

/// The master's work: four divisions per match.
template <class P>
void gather(const FrontEndState<P>& state, const Frame<P>& frame, const CameraConstants<P>& camera,
            const Views<P>& views) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const KeyframeMatches<P>& matches = frame.matches;
  for (int i : P::range(0, matches.list.count)) {
    const I32 now = matches.list.query[i];
    const I32 old = matches.list.reference[i];
    const F old_u = state.camera.pixel(matches.u(old)), old_v = state.camera.pixel(matches.v(old));
    const F u = state.camera.pixel(frame.features.list.x[now]);
    const F v = state.camera.pixel(frame.features.list.y[now]);
    put<P>(views.pixels_a, i, old_u, old_v);
    put<P>(views.pixels_b, i, u, v);
    const Vec2<P> a = camera.normalised(old_u, old_v);
    const Vec2<P> b = camera.normalised(u, v);
    put<P>(views.a, i, a.x, a.y);
    put<P>(views.b, i, b.x, b.y);
  }
}

}  // namespace

template <class P>
Pose<P> pose_from_keyframe(const FrontEndState<P>& state, ShiftRegister<P>& random,
                           const Frame<P>& frame, FrameReport& report) {
  using F = typename P::F32;
  const Profile& profile = state.profile;
  const KeyframeState<P> last = state.newest_keyframe();
  const int n = frame.matches.list.count;
  report.source = PoseSource::Kept;
  if (n < profile.min_frame_matches) return last.T_world_camera;

  work::Machine& machine = state.machine;
  work::Arena& local = machine.local();
  const work::Arena::Frame memory(local);
  const auto stage = machine.stage(stages::kEightPoint);
  const CameraConstants<P> camera(state.rig.camera);
  const Views<P> views(local, n);
  const auto inliers = local.alloc<typename P::template Span<typename P::Byte>>("inlier mask", n);
  const MatrixView<P> essential = alloc_matrix<P>(local, "best essential matrix", 3, 3);
  gather(state, frame, camera, views);
  const F pixel = F(profile.essential.inlier_px) / camera.fx();
  const EssentialResult<P> found = estimate_essential<P>(
      machine, views.normalised(n), pixel * pixel, random, {}, essential, inliers);
  if (!found.ok) return last.T_world_camera;
  const RecoveredPose<P> motion = recover_pose<P>(machine, essential, views.pixels(n), camera);
  if (!motion.ok) return last.T_world_camera;

  report.source = PoseSource::EightPoint;
  report.inliers = found.inliers;
  const F dt = std::min(state.time_since_keyframe, profile.max_translation_time);
  const F length = work::max(F(norm(last.velocity) * dt), F(profile.min_translation));
  const Pose<P> T_camera_keyframe{motion.T_b_a.R, motion.T_b_a.t * length};
  return last.T_world_camera * inverse(T_camera_keyframe);
}

template Pose<work::Native> pose_from_keyframe(const FrontEndState<work::Native>&,
                                               ShiftRegister<work::Native>&,
                                               const Frame<work::Native>&, FrameReport&);
template Pose<work::Counting> pose_from_keyframe(const FrontEndState<work::Counting>&,
                                                 ShiftRegister<work::Counting>&,
                                                 const Frame<work::Counting>&, FrameReport&);

}  // namespace leviosim::vio::levio
