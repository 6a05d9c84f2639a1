// Sliding-window bundle adjustment with pre-integrated IMU (paper section III.C, eqs 5 and 6): one
// call is one Levenberg-Marquardt iteration on a snapshot of the pose graph, on one core whose
// local memory holds the snapshot (the fabric controller and L2). The paper runs three per frame,
// about 5.5 Mcycles each at a full window (PARAMETERS.md#optimiser).
//
// An iteration linearises all residuals, eliminates the landmarks, solves the damped reduced
// system, and keeps the step if the cost falls. A rejected step is followed by a stronger damping;
// the next iteration linearises anew even so, which keeps the work of an iteration constant.
//
// Unknowns per keyframe: rotation (right perturbation), position, and with IMU velocity. Without
// IMU the window has no scale of its own: only the damping holds it.
//
// Two ways of taking the IMU and the past into account:
//   optimise_once()          biases apart (window.h, estimate_biases); the anchor
//   (inertial_terms.h)
//                            stands in for what is known from keyframes that have left
//   optimise_jointly_once()  biases as unknowns (joint_inertial_terms.h), and the departed
//                            keyframes marginalised (marginalisation.h)
#pragma once

#include <optional>

#include "sim/work/machine.h"
#include "workload/graph/inertial_terms.h"
#include "workload/graph/marginalisation.h"
#include "workload/graph/reprojection.h"
#include "workload/graph/window.h"

namespace leviosim::vio {

struct OptimiserOptions {
  ReprojectionOptions visual;
  AnchorOptions anchor;
  bool use_imu = true;
  bool joint = false;  ///< optimise_jointly_once(), with `prior` instead of `anchor`
  PriorOptions prior;
  float initial_lambda = 1e-4f;
  float lambda_up = 10.0f;   ///< factor after a rejected step
  float lambda_down = 0.1f;  ///< factor after an accepted one
  float min_lambda = 1e-6f;  ///< single precision needs that much to stay positive definite
  float max_lambda = 1e4f;
};

/// What carries over from one iteration to the next; start afresh with each snapshot.
template <class P>
struct LmState {
  explicit LmState(const OptimiserOptions& options) : lambda(options.initial_lambda) {}

  typename P::F32 lambda;
};

struct IterationReport {
  bool positive_definite = false;  ///< the reduced system could be factored
  bool accepted = false;
  float cost_before = 0;  ///< half the sum of squared, whitened residuals
  float cost_after = 0;   ///< cost at the attempted step; cost_before if there was none
  float lambda = 0;       ///< damping of this iteration
  int landmarks = 0;      ///< landmarks of the window that were used
  int observations = 0;   ///< their observations that were used
  // Parts of cost_before.
  float visual = 0;
  float inertial = 0;
  float prior = 0;  ///< of the marginalisation prior, or of the anchor in its place
  /// Standard deviation of the scale of the keyframes' positions, as a share of it; only of joint
  /// iterations of a full window with little damping.
  std::optional<float> scale_sigma;
};

/// One iteration; changes `window.state`. Must run in a stage of `fc`, whose local memory it uses
/// for its work memory, freed on return: 710 kB for 8 keyframes and 1000 landmarks.
/// A window of fewer than two keyframes is left as it is.
template <class P>
IterationReport optimise_once(work::Machine& fc, Window<P>& window, LmState<P>& lm,
                              const OptimiserOptions& options);

/// Optimises the window with the biases as unknowns, a lever arm, and a prior from marginalisation
/// in place of the anchor; changes `window.bias` as well.
template <class P>
IterationReport optimise_jointly_once(work::Machine& fc, Window<P>& window,
                                      const WindowPrior<P>& prior, LmState<P>& lm,
                                      const OptimiserOptions& options);

}  // namespace leviosim::vio
