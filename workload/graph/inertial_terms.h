// The inertial part of the optimiser and the anchor: added to the reduced normal equations with the
// same sign as the visual part, H += Jᵀ J and b -= Jᵀ r, so that the system stays positive definite
// (PARAMETERS.md#defects-of-the-release).
//
// Residuals of an interval (inertial/residual.h) are whitened with the Cholesky factor of their
// covariance, which holds the noise of gyro and accelerometer and the uncertainty of gravity
// (window.h).
//
// The anchor holds the oldest keyframe to where it was when the snapshot was taken: position and
// heading, which neither sensor observes, and, weakly tied, what the window has forgotten. Its
// derivative by the rotation is taken as the identity, which its small residual allows. The
// velocity of the very first keyframe has not been estimated by any window before; it is tied more
// weakly.
#pragma once

#include "workload/graph/reduced_system.h"
#include "workload/graph/window.h"

namespace leviosim::vio {

/// Standard deviations of the oldest keyframe around the anchor; 0 leaves a part free.
struct AnchorOptions {
  float rotation = 1e-3f;         ///< rad
  float position = 1e-3f;         ///< m
  float velocity = 0.0f;          ///< m/s; only with IMU
  float initial_velocity = 0.0f;  ///< instead, while the oldest keyframe is the first of all
};

/// Scratch for one interval: 9 rows; derivatives by both keyframes (18), then the residual.
template <class P>
struct IntervalScratch {
  static constexpr int kColumns = 19;

  explicit IntervalScratch(work::Arena& arena)
      : rows(alloc_matrix<P>(arena, "interval Jacobian", 9, kColumns)) {}

  MatrixView<P> rows;
};

/// Adds all intervals of the window at its state.
/// @return their cost
template <class P>
typename P::F32 add_inertial_terms(const Window<P>& window, const IntervalScratch<P>& scratch,
                                   const ReducedSystem<P>& system);

/// Cost of all intervals at `state`.
template <class P>
typename P::F32 inertial_cost(const Window<P>& window, const WindowState<P>& state,
                              const IntervalScratch<P>& scratch);

/// Adds the anchor.
/// @return its cost
template <class P>
typename P::F32 add_anchor(const Window<P>& window, const AnchorOptions& options,
                           const ReducedSystem<P>& system);

template <class P>
typename P::F32 anchor_cost(const Window<P>& window, const WindowState<P>& state,
                            const AnchorOptions& options, bool with_velocity);

}  // namespace leviosim::vio
