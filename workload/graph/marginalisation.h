// What is known of a window from the keyframes that have left it: a quadratic cost of its first
// keyframes and the biases, by marginalisation of the departed (Schur complement).
//
// With H and b the prior and x ⊟ x₀ the difference to the state at which it was linearised
// (rotation by the logarithm, its right Jacobian taken as the identity), the cost is
//   ½ (x ⊟ x₀)ᵀ H (x ⊟ x₀) − bᵀ (x ⊟ x₀),
// up to a constant, so it may be negative.
//
// When keyframes leave, the prior takes in what they alone knew: the prior so far, the intervals
// from them to the next keyframe, and the landmarks that they saw, whose observations then count no
// more (forget_departed()). The biases have walked meanwhile: noise q added to an unknown i changes
// H by −h hᵀ q/(1 + q H_ii) with h its column i, and the same for b, which leaves the estimate
// where it is.
//
// Position and heading of all keyframes together, which no sensor observes, are not in the prior.
// To hold the oldest keyframe in it would say, when that keyframe departs, that the next one is
// where it is believed to be: that the distance between them, and so the scale, is known.
//
// Left out: first-estimate Jacobians, with which nine flights were no better (ACCURACY.md).
#pragma once

#include "sim/work/machine.h"
#include "workload/graph/joint_inertial_terms.h"
#include "workload/graph/reprojection.h"
#include "workload/graph/window.h"

namespace leviosim::vio {

/// Standard deviations of the prior of the first keyframe, and of the gauge.
struct PriorOptions {
  float position = 1e-3f;   ///< position of the oldest keyframe [m]
  float heading = 1e-3f;    ///< heading of the oldest keyframe [rad]
  float tilt = 0.1f;        ///< tilt of the first keyframe: gravity averaged in motion [rad]
  float velocity = 1.0f;    ///< velocity of the first keyframe [m/s]
  float gyro_bias = 0.1f;   ///< bias of the gyro [rad/s]
  float accel_bias = 0.1f;  ///< bias of the accelerometer [m/s²]
  // Tilt, velocity and gyro bias of a vehicle that was at rest at first: the velocity is that of
  // the moment in which it starts to move, tilt and bias are means over a second, the tilt with the
  // error from the accelerometer's bias.
  float rest_tilt = 0.02f;
  float rest_velocity = 0.1f;
  float rest_gyro_bias = 0.005f;
  float gyro_walk = 1.9393e-5f;  ///< density, rad/s²/√Hz (EuRoC's sensor.yaml)
  float accel_walk = 3e-3f;      ///< density, m/s³/√Hz (as that of the gyroscope)
  /// Of each unknown's information, added to it before keyframes are eliminated, so that rounding
  /// in single precision leaves none without.
  float floor = 1e-6f;
  /// Also landmarks that the newest keyframe sees are marginalised, though they stay in the window:
  /// their observations count twice. Otherwise the departed keyframe's observations of them are
  /// dropped.
  bool tracked_landmarks = false;
};

/// The prior in memory: for 8 keyframes 25 kB. A bundle of views: copies share the memory.
template <class P>
struct WindowPrior {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;

  WindowPrior() = default;
  WindowPrior(work::Arena& arena, int keyframes);

  int unknowns() const { return unknowns_of(keyframes); }
  static int unknowns_of(int keyframes) {
    return ReducedSystem<P>::kPoseAndVelocityUnknowns * keyframes + kBiasUnknowns;
  }

  int keyframes = 0;     ///< the first ones of the window; 0 while nothing is known
  Span information;      ///< H, unknowns()², both triangles
  Span vector;           ///< b
  Span difference;       ///< scratch
  WindowState<P> state;  ///< linearised at
  ImuBias<P> bias = ImuBias<P>::zero();
};

/// The prior of a window that begins with the very first keyframe. It began at rest if the
/// window's prior of the gyro's bias says so, which is tighter then.
template <class P>
void start_prior(const Window<P>& window, const PriorOptions& options, WindowPrior<P>& prior);

/// Replaces the prior of `window` by that of the same window without its `departed` oldest
/// keyframes (0 < departed < window.keyframes). Work memory as for an iteration.
template <class P>
void marginalise(work::Machine& machine, const Window<P>& window, int departed,
                 const ReprojectionOptions& visual, const PriorOptions& options,
                 WindowPrior<P>& prior);

/// Adds the prior at the window's state.
/// @return its cost
template <class P>
typename P::F32 add_prior(const WindowPrior<P>& prior, const Window<P>& window,
                          const ReducedSystem<P>& system);

template <class P>
typename P::F32 prior_cost(const WindowPrior<P>& prior, const WindowState<P>& state,
                           const ImuBias<P>& bias);

/// Holds position and heading of the oldest keyframe, which no sensor observes, where the prior has
/// them. Not part of the prior: it would be taken for knowledge when that keyframe departs.
/// @return its cost
template <class P>
typename P::F32 hold_gauge(const WindowPrior<P>& prior, const WindowState<P>& state,
                           const PriorOptions& options, const ReducedSystem<P>& system);

/// The cost that hold_gauge() would return at `state`.
template <class P>
typename P::F32 gauge_cost(const WindowPrior<P>& prior, const WindowState<P>& state,
                           const PriorOptions& options);

/// Eliminates the first n unknowns of a system: the rest is their Schur complement. An unknown
/// without information is skipped.
template <class P>
void eliminate_first(const ReducedSystem<P>& system, int n);

}  // namespace leviosim::vio
