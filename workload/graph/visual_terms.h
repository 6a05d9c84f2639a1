// The visual part of the optimiser: linearises all observations into the landmark records, adds
// them to the normal equations of the keyframes while eliminating one landmark after the other
// (Schur complement, paper eq. 6), and recovers the landmarks' steps afterwards.
//
// Minimised is half the sum of squares. With J the derivatives and r the residuals of a landmark,
//   H_pp = J_pᵀ J_p,  W = J_pᵀ J_l,  H_ll = J_lᵀ J_l,  b = -Jᵀ r,
// the reduced system gets H_pp - W H_ll⁻¹ Wᵀ and b_p - W H_ll⁻¹ b_l. H_ll is damped (its diagonal
// grows by the factor 1 + λ) before it is inverted.
//
// A landmark whose damped block is not positive definite, or with fewer than two observations that
// are not lost (reprojection.h), is left out of the iteration, stays where it is, and is marked as
// lost in the window.
#pragma once

#include "workload/graph/landmark_records.h"
#include "workload/graph/reduced_system.h"
#include "workload/graph/reprojection.h"
#include "workload/graph/window.h"

namespace leviosim::vio {

/// Scratch for one landmark: the blocks W of its observations, and W H_ll⁻¹ of one of them.
template <class P>
struct EliminationScratch {
  using Span = typename P::template Span<typename P::F32>;

  EliminationScratch(work::Arena& arena, int keyframes)
      : W(arena.alloc<Span>("elimination W", 18 * keyframes)),
        Y(arena.alloc<Span>("elimination Y", 18)) {}

  Span W;  ///< 6×3 per observation
  Span Y;  ///< 6×3
};

/// Landmarks and observations of a window that one linearisation used.
struct VisualUse {
  int landmarks = 0;     ///< number of landmarks used
  int observations = 0;  ///< number of their observations, without the lost ones
};

/// Linearises landmark after landmark at `window.state` and adds each to `system`.
/// @param machine  behind whose local memory records may lie
/// @return how much of the window took part; the cost is added to `cost`
template <class P>
VisualUse add_visual_terms(work::Machine& machine, const Window<P>& window,
                           const PixelModel<P>& model, typename P::F32 lambda,
                           const LandmarkRecords<P>& records, const EliminationScratch<P>& scratch,
                           const ReducedSystem<P>& system, typename P::F32& cost);

/// Steps of the landmarks for the keyframes' step, added to the points: to = from + step.
template <class P>
void step_points(work::Machine& machine, const Window<P>& window, const LandmarkRecords<P>& records,
                 const ReducedSystem<P>& solved, typename P::template Span<typename P::F32> to);

/// Puts back the points of `trial` that their step led out of sight, where they are better off
/// unmoved: the depth of a landmark with little parallax is hardly determined, and its step may
/// lead anywhere. Without this a single such landmark has the steps of all others rejected.
/// @return the cost of all observations at `trial` then
template <class P>
typename P::F32 settle_points(const Window<P>& window, const WindowState<P>& trial,
                              const PixelModel<P>& model);

template <class P>
struct LandmarkCost {
  typename P::F32 cost;
  bool lost;  ///< an observation is
};

/// settle_points(), with what a landmark costs.
/// @param cost_at  (landmark, point) -> LandmarkCost, seen from the keyframes of `trial`
template <class P, class CostAt>
inline typename P::F32 settle_by_cost(const Window<P>& window, const WindowState<P>& trial,
                                      const CostAt& cost_at) {
  using F = typename P::F32;
  F cost = 0.0f;
  for (int i : P::range(0, window.landmarks)) {
    LandmarkCost<P> at = cost_at(i, load_vec3<P>(trial.points, 3 * i));
    if (at.lost) {
      const Vec3<P> before = load_vec3<P>(window.state.points, 3 * i);
      const LandmarkCost<P> unmoved = cost_at(i, before);
      if (unmoved.cost < at.cost) {
        store_vec3<P>(trial.points, 3 * i, before);
        at = unmoved;
      }
    }
    cost += at.cost;
  }
  return cost;
}

}  // namespace leviosim::vio
