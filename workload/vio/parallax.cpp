#include "workload/vio/parallax.h"

#include "workload/math/solve.h"

namespace leviosim::vio {
namespace {

/// What undoes the rotation since the keyframe.
template <class P>
Mat3<P> rotation_to_undo(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                         const Frame<P>& frame) {
  if (state.profile.use_imu) return transpose(inertial.motion_since_keyframe().R);
  const KeyframeState<P> last = state.newest_keyframe();
  return transpose(frame.T_world_camera.R) * last.T_world_camera.R;
}

template <class P>
struct Parallax {
  Vec2<P> seen;  ///< normalised
  Vec2<P> moved;
};

/// Of match i.
template <class P>
Parallax<P> parallax_of(const FrontEndState<P>& state, const Frame<P>& frame, int i,
                        const Mat3<P>& R_camera_keyframe) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const KeyframeMatches<P>& matches = frame.matches;
  const FeatureList<P>& features = frame.features.list;
  const I32 now = matches.list.query[i];
  const I32 old = matches.list.reference[i];
  const Vec2<P> seen = state.camera.normalised(features.x[now], features.y[now]);
  const Vec2<P> before = state.camera.normalised(matches.u(old), matches.v(old));
  const Vec3<P> turned = R_camera_keyframe * Vec3<P>{before.x, before.y, 1.0f};
  const F scale = F(1.0f) / turned.z;
  return {seen, {seen.x - turned.x * scale, seen.y - turned.y * scale}};
}

}  // namespace

template <class P>
typename P::F32 total_parallax(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                               const Frame<P>& frame) {
  using F = typename P::F32;
  const typename P::Function function("total_parallax");
  const Mat3<P> R_camera_keyframe = rotation_to_undo(state, inertial, frame);
  F sum = 0.0f;
  for (int i : P::range(0, frame.matches.list.count)) {
    const Vec2<P> moved = parallax_of(state, frame, i, R_camera_keyframe).moved;
    sum += work::sqrt(F(moved.x * moved.x + moved.y * moved.y));
  }
  return sum;
}

/// A camera that moves by t sees a point at distance d and (x, y) move by (x t.z - t.x) / d and
/// (y t.z - t.y) / d.
template <class P>
std::optional<Vec3<P>> motion_over_distance(const FrontEndState<P>& state, const Frame<P>& frame,
                                            const Mat3<P>& R_camera_keyframe, float most) {
  using F = typename P::F32;
  F x = 0.0f, y = 0.0f, radius_sq = 0.0f;
  Vec3<P> b{0.0f, 0.0f, 0.0f};
  int near = 0;
  for (int i : P::range(0, frame.matches.list.count)) {
    const auto [seen, moved] = parallax_of(state, frame, i, R_camera_keyframe);
    if (moved.x * moved.x + moved.y * moved.y > F(most * most)) continue;
    ++near;
    x += seen.x;
    y += seen.y;
    radius_sq += seen.x * seen.x + seen.y * seen.y;
    b = b + Vec3<P>{-moved.x, -moved.y, moved.x * seen.x + moved.y * seen.y};
  }
  const auto count = static_cast<float>(near);
  const Mat3<P> H{{{count, 0.0f, -x}, {0.0f, count, -y}, {-x, -y, radius_sq}}};
  Mat3<P> inverse;
  if (near < state.profile.min_frame_matches || 2 * near < frame.matches.list.count ||
      !invert_spd3<P>(H, inverse))
    return std::nullopt;
  return inverse * b;
}

template work::Native::F32 total_parallax(const FrontEndState<work::Native>&,
                                          const InertialPart<work::Native>&,
                                          const Frame<work::Native>&);
template work::Counting::F32 total_parallax(const FrontEndState<work::Counting>&,
                                            const InertialPart<work::Counting>&,
                                            const Frame<work::Counting>&);
template std::optional<Vec3<work::Native>> motion_over_distance(const FrontEndState<work::Native>&,
                                                                const Frame<work::Native>&,
                                                                const Mat3<work::Native>&, float);
template std::optional<Vec3<work::Counting>> motion_over_distance(
    const FrontEndState<work::Counting>&, const Frame<work::Counting>&, const Mat3<work::Counting>&,
    float);

}  // namespace leviosim::vio
