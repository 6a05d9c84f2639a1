#include "workload/vio/parallax.h"

namespace leviosim::vio {

template <class P>
typename P::F32 total_parallax(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                               const Frame<P>& frame) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const KeyframeMatches<P>& matches = frame.matches;
  const FeatureList<P>& features = frame.features.list;
  Mat3<P> R_camera_keyframe = Mat3<P>::identity();
  if (state.profile.parallax_without_rotation && state.profile.use_imu) {
    R_camera_keyframe = transpose(inertial.motion_since_keyframe().R);
  } else if (state.profile.parallax_without_rotation) {
    const KeyframeState<P> last = state.newest_keyframe();
    R_camera_keyframe = transpose(frame.T_world_camera.R) * last.T_world_camera.R;
  }
  F sum = 0.0f;
  for (int i : P::range(0, matches.list.count)) {
    const I32 now = matches.list.query[i];
    const I32 old = matches.list.reference[i];
    const Vec2<P> seen = state.camera.normalised(features.x[now], features.y[now]);
    const Vec2<P> before = state.camera.normalised(matches.u(old), matches.v(old));
    const Vec3<P> turned = R_camera_keyframe * Vec3<P>{before.x, before.y, 1.0f};
    const F scale = F(1.0f) / turned.z;
    const F x = seen.x - turned.x * scale;
    const F y = seen.y - turned.y * scale;
    sum += work::sqrt(F(x * x + y * y));
  }
  return sum;
}

template work::Native::F32 total_parallax(const FrontEndState<work::Native>&,
                                          const InertialPart<work::Native>&,
                                          const Frame<work::Native>&);
template work::Counting::F32 total_parallax(const FrontEndState<work::Counting>&,
                                            const InertialPart<work::Counting>&,
                                            const Frame<work::Counting>&);

}  // namespace leviosim::vio
