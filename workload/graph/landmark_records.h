// The optimiser's work memory: one record of Jacobian blocks per landmark (paper section IV.B,
// "Optimizer" in its memory table: up to 743.6 kB of L2).
//
// A record has a slot for each keyframe of the window, used for the landmark's observations in
// their order, and the landmark's own block:
//   per slot   2×6 derivative by the pose (rotation, position), 2×3 derivative by the landmark,
//              2 residuals: 80 bytes
//   at the end the inverse of the landmark's block of the normal equations (6, symmetric) and its
//              right-hand side (3): 36 bytes
// For 8 keyframes and 1000 landmarks 676 kB.
#pragma once

#include "workload/graph/reprojection.h"
#include "workload/graph/window.h"
#include "workload/inertial/record.h"
#include "workload/math/matrix.h"

namespace leviosim::vio {

template <class P>
class LandmarkRecords {
 public:
  using F = typename P::F32;
  using Span = typename P::template Span<F>;

  // Places in a slot.
  static constexpr int kByPose = 0;    ///< two rows of 6
  static constexpr int kByPoint = 12;  ///< two rows of 3
  static constexpr int kResidual = 18;
  static constexpr int kSlotFloats = 20;
  // Places in the landmark's own block.
  static constexpr int kInverse = 0;
  static constexpr int kRightHandSide = 6;
  static constexpr int kOwnFloats = 9;

  LandmarkRecords(work::Arena& arena, int landmarks, int keyframes)
      : floats_(keyframes * kSlotFloats + kOwnFloats),
        keyframes_(keyframes),
        memory_(arena.alloc<Span>("landmark Jacobian records", landmarks * floats_)) {}

  /// Floats of a record.
  int floats() const { return floats_; }
  Span record(int i) const { return memory_.subspan(i * floats_, floats_); }
  /// Slot of the j-th observation of landmark i.
  Span slot(int i, int j) const {
    return memory_.subspan(i * floats_ + j * kSlotFloats, kSlotFloats);
  }
  /// Landmark i's own block.
  Span own(int i) const {
    return memory_.subspan(i * floats_ + keyframes_ * kSlotFloats, kOwnFloats);
  }

  void store_inverse(int i, const Mat3<P>& inverse) const {
    const Span to = own(i);
    int at = kInverse;
    for (int r = 0; r < 3; ++r)
      for (int c = r; c < 3; ++c) to[at++] = inverse.m[r][c];
  }
  Mat3<P> inverse(int i) const {
    const Span from = own(i);
    const F xx = from[0], xy = from[1], xz = from[2], yy = from[3], yz = from[4], zz = from[5];
    return {{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
  }

 private:
  int floats_;
  int keyframes_;
  Span memory_;
};

// The landmark records filled: each observation's residual and derivatives by
// its keyframe's pose and by the landmark.

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
