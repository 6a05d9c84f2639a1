// The landmark records filled: each observation's residual and derivatives by
// its keyframe's pose and by the landmark.
#pragma once

#include "workload/graph/landmark_records.h"
#include "workload/graph/reprojection.h"
#include "workload/graph/window.h"
#include "workload/inertial/record.h"

namespace leviosim::vio {

template <class P>
void store_term(typename P::template Span<typename P::F32> slot, const VisualTerm<P>& term) {
  for (int row = 0; row < 2; ++row) {
    store_vec3<P>(slot, LandmarkRecords<P>::kByPose + 6 * row, term.by_rotation[row]);
    store_vec3<P>(slot, LandmarkRecords<P>::kByPose + 6 * row + 3, -term.by_point[row]);
    store_vec3<P>(slot, LandmarkRecords<P>::kByPoint + 3 * row, term.by_point[row]);
    slot[LandmarkRecords<P>::kResidual + row] = term.residual[row];
  }
}

/// Pose of keyframe k, known only from data.
template <class P>
Pose<P> pose_of(const WindowState<P>& state, typename P::I32 k) {
  using I32 = typename P::I32;
  const I32 at = k * I32(kPoseFloats);
  return load_pose<P>(state.poses.subspan(at, kPoseFloats), 0);
}

template <class P>
Vec2<P> observed_pixel(const Window<P>& window, int o) {
  using I32 = typename P::I32;
  return {work::to_f32(I32(window.observation_u[o])), work::to_f32(I32(window.observation_v[o]))};
}

/// Fills the slots of landmark i. Lost observations get zeros.
/// @return the number of the others
template <class P>
typename P::I32 linearise_landmark(const Window<P>& window, const PixelModel<P>& model, int i,
                                   const LandmarkRecords<P>& records, typename P::F32& cost) {
  using I32 = typename P::I32;
  const int first = work::value(I32(window.first_observations[i]));
  const int number = work::value(I32(window.observation_numbers[i]));
  const Vec3<P> point = load_vec3<P>(window.state.points, 3 * i);
  I32 valid = 0;
  for (int j : P::range(0, number)) {
    const typename P::Code code("linearise_observation");
    const auto slot = records.slot(i, j);
    // uncounted: where a landmark's observations begin
    const Pose<P> T = pose_of<P>(window.state, window.observation_keyframes[first + j]);
    const Vec3<P> in_camera = transpose(T.R) * (point - T.t);
    Projection<P> at;
    if (!project<P>(model, in_camera, observed_pixel<P>(window, first + j), at)) {
      for (int e : P::range(0, LandmarkRecords<P>::kSlotFloats)) slot[e] = 0.0f;
      cost += model.lost_cost;
      continue;
    }
    cost += huber_cost<P>(model, at.error_sq);
    store_term<P>(slot, linearise<P>(model, T.R, at));
    ++valid;
  }
  return valid;
}

}  // namespace leviosim::vio
