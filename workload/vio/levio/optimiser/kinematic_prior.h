// The kinematic prior of the released program (PARAMETERS.md#optimiser): the velocity of a keyframe
// is that of the way from the one before, v_j = (p_j − p_i) / Δt.
#pragma once

#include "workload/graph/reduced_system.h"
#include "workload/graph/window.h"

namespace leviosim::vio::levio {

namespace kinematic {

inline constexpr int kPosition = 3, kVelocity = 6;  ///< places in a keyframe's unknowns

template <class P>
Vec3<P> residual(const WindowState<P>& state, int k, typename P::F32 rate) {
  const KeyframeState<P> end = state.keyframe(k);
  return end.velocity - (end.T_world_camera.t - state.pose(k - 1).t) * rate;
}

/// Reciprocal of the time between keyframes k - 1 and k; 0 if there is no interval.
template <class P>
typename P::F32 rate_of(const Window<P>& window, int k) {
  using F = typename P::F32;
  const F duration = window.interval(k).duration();
  if (!(duration > 0.0f)) return 0.0f;
  return F(1.0f) / duration;
}

}  // namespace kinematic

/// Adds the prior of all intervals.
template <class P>
void add_kinematic_prior(const Window<P>& window, typename P::F32 weight,
                         const ReducedSystem<P>& system) {
  using F = typename P::F32;
  const typename P::Function function("levio_add_kinematic_prior");
  const MatrixView<P> matrix = system.matrix();
  const auto b = system.vector();
  for (int k : P::range(1, window.keyframes)) {
    const F rate = kinematic::rate_of<P>(window, k);
    if (!(rate > 0.0f)) continue;
    const Vec3<P> r = kinematic::residual<P>(window.state, k, rate);
    const F residual[3] = {r.x, r.y, r.z};
    const int before = (k - 1) * system.per_keyframe() + kinematic::kPosition;
    const int position = k * system.per_keyframe() + kinematic::kPosition;
    const int velocity = k * system.per_keyframe() + kinematic::kVelocity;
    const F by_way = weight * rate;
    const F by_both = by_way * rate;
    for (int c = 0; c < 3; ++c) {
      // Derivatives: rate by the position before, −rate by the position, 1 by the velocity.
      matrix(before + c, before + c) += by_both;
      matrix(position + c, position + c) += by_both;
      matrix(velocity + c, velocity + c) += weight;
      matrix(position + c, before + c) -= by_both;
      matrix(velocity + c, before + c) += by_way;
      matrix(velocity + c, position + c) -= by_way;
      b[before + c] -= by_way * residual[c];
      b[position + c] += by_way * residual[c];
      b[velocity + c] -= weight * residual[c];
    }
  }
}

template <class P>
typename P::F32 kinematic_cost(const Window<P>& window, const WindowState<P>& state,
                               typename P::F32 weight) {
  using F = typename P::F32;
  const typename P::Function function("levio_kinematic_cost");
  F sum = 0.0f;
  for (int k : P::range(1, window.keyframes)) {
    const F rate = kinematic::rate_of<P>(window, k);
    if (!(rate > 0.0f)) continue;
    const Vec3<P> r = kinematic::residual<P>(state, k, rate);
    sum += F(dot(r, r));
  }
  return 0.5f * weight * sum;
}

}  // namespace leviosim::vio::levio
