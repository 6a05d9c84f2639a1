#include "workload/vio/two_view_pose.h"

#include <algorithm>

#include "workload/geometry/essential_ransac.h"
#include "workload/geometry/recover_pose.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {
namespace {

/// Both views of all matches, in L1.
template <class P>
TwoViewMatches<P> gather_views(const FrontEndState<P>& state, const Frame<P>& frame,
                               typename P::template Span<typename P::F32> a,
                               typename P::template Span<typename P::F32> b) {
  using I32 = typename P::I32;
  const KeyframeMatches<P>& matches = frame.matches;
  for (int i : P::range(0, matches.list.count)) {
    const I32 now = matches.list.query[i];
    const I32 old = matches.list.reference[i];
    const Vec2<P> in_a = state.camera.normalised(matches.u(old), matches.v(old));
    const Vec2<P> in_b =
        state.camera.normalised(frame.features.list.x[now], frame.features.list.y[now]);
    a[2 * i] = in_a.x;
    a[2 * i + 1] = in_a.y;
    b[2 * i] = in_b.x;
    b[2 * i + 1] = in_b.y;
  }
  return {a, b, matches.list.count};
}

}  // namespace

template <class P>
Pose<P> pose_from_keyframe(const FrontEndState<P>& state, const Frame<P>& frame,
                           const RotationCheck<P>& can_be_true, FrameReport& report) {
  using F = typename P::F32;
  using Floats = typename P::template Span<F>;
  const Profile& profile = state.profile;
  const KeyframeState<P> last = state.newest_keyframe();
  const int matches = frame.matches.list.count;
  report.source = PoseSource::Kept;
  if (matches < profile.min_frame_matches) return last.T_world_camera;

  work::Machine& machine = state.machine;
  work::Arena& local = machine.local();
  const work::Arena::Frame memory(local);
  const auto stage = machine.stage(stages::kEightPoint);
  const auto a = local.alloc<Floats>("matched points of the keyframe", 2 * matches);
  const auto b = local.alloc<Floats>("matched points", 2 * matches);
  const auto inliers =
      local.alloc<typename P::template Span<typename P::Byte>>("inlier mask", matches);
  const TwoViewMatches<P> views = gather_views(state, frame, a, b);
  EssentialOptions options = profile.essential;
  options.seed += state.frame_number;
  const EssentialResult<P> essential =
      estimate_essential<P>(machine, views, state.rig.camera.fx, options, inliers);
  if (!essential.ok) return last.T_world_camera;
  const TwoViewPose<P> motion = recover_pose<P>(machine, views, inliers, essential.E);
  if (!motion.ok) return last.T_world_camera;
  if (can_be_true && !can_be_true(motion.T_b_a.R)) return last.T_world_camera;

  report.source = PoseSource::EightPoint;
  report.inliers = essential.inliers;
  const F dt = std::min(state.time_since_keyframe, profile.max_translation_time);
  const F length = work::max(F(norm(last.velocity) * dt), F(profile.min_translation));
  const Pose<P> T_camera_keyframe{motion.T_b_a.R, motion.T_b_a.t * length};
  return last.T_world_camera * inverse(T_camera_keyframe);
}

template Pose<work::Native> pose_from_keyframe(const FrontEndState<work::Native>&,
                                               const Frame<work::Native>&,
                                               const RotationCheck<work::Native>&, FrameReport&);
template Pose<work::Counting> pose_from_keyframe(const FrontEndState<work::Counting>&,
                                                 const Frame<work::Counting>&,
                                                 const RotationCheck<work::Counting>&,
                                                 FrameReport&);

}  // namespace leviosim::vio
