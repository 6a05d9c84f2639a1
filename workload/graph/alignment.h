// Visual-inertial initialisation: what a map needs that begins in motion. Over a window of
// keyframes with tracked features and pre-integrated IMU it finds velocity, gravity, both biases
// and with them the scale, all at once: the IMU carries the first keyframe through the window
// (carried_poses.h), so that thirteen numbers and the landmarks explain all observations. Minimised
// are reprojection errors, as the optimiser does it (Huber loss), with landmarks as a direction and
// an inverse depth in the keyframe that saw them first, by Levenberg-Marquardt, the landmarks
// eliminated.
//
// How far away the landmarks are is not assumed: their inverse depths lie about a mean that is an
// unknown too, with a spread that is a share of it. So the scale of the whole costs nothing, and
// motion and gravity decide it.
//
// No structure from motion comes first, for which two views at a base line of a few pixels are a
// poor start: rotation comes from the gyro but for its bias, and translation is linear in what is
// looked for. Any landmarks in front of the camera will do to begin with.
//
// Observability: the covariance of the unknowns gives that of the keyframes' positions. While they
// are uncertain beside their distances from the first one, the window has not seen enough motion,
// and the map waits.
//
// Left out: the noise of the IMU in the window, which the optimiser takes up afterwards.
#pragma once

#include "workload/graph/marginalisation.h"
#include "workload/graph/optimiser.h"

namespace leviosim::vio {

/// What is assumed before anything is known, in standard deviations, and when enough is known.
struct AlignmentOptions {
  bool enabled = false;
  float inverse_depth = 3;  ///< inverse depth of new landmarks at the start [1/m]
  float spread = 1;         ///< standard deviation of inverse depths, as a share of their mean
  /// In place of spread while the window has few keyframes: with all landmarks about equally far
  /// away the problem is nearly linear, and its solution is near enough to start from.
  float first_spread = 0.33f;
  float velocity = 3;      ///< velocity of the first keyframe [m/s]
  float acceleration = 2;  ///< mean acceleration over the window [m/s²]
  float first_gyro_bias =
      0.03f;              ///< gyro bias with few keyframes, in place of the optimiser's [rad/s]
  int min_keyframes = 3;  ///< least keyframes of a window that is aligned
  int few_keyframes = 4;  ///< up to so many, first_spread holds and no map is aligned
  float initial_lambda = 1e-2f;  ///< damping with every new keyframe
  // A map is aligned when all of these hold.
  float max_distance = 3;         ///< distance from the minimum, in standard deviations
  float max_uncertainty = 0.05f;  ///< uncertainty of positions, as a share of their distances
  float full_uncertainty = 4;     ///< factor on it where the window has no room for more keyframes
  /// Deviation of velocity, biases and gravity from their priors together, in standard deviations.
  float max_prior_deviation = 2.5f;
  float min_explained = 0.7f;  ///< least share of the landmarks that agree with the alignment
  int min_landmarks = 30;      ///< least number of these whose depth is known
  // Comparison of several starts.
  float same_scale = 1.2f;  ///< ratio of the lengths of two paths below which they are one solution
  /// Difference of the costs (half a chi-square) below which two solutions are ambiguous.
  float min_advantage = 4.5f;
  int start_iterations = 12;  ///< most iterations of each start
};

struct AlignmentReport : IterationReport {
  float distance = 0;  ///< distance from the minimum before the iteration, in standard deviations
  /// Uncertainty of positions, as a share of their distances from the first one (RMS).
  float uncertainty = 0;
  int explained = 0;        ///< landmarks that agree with the alignment
  bool arrived = false;     ///< it is at its minimum: more iterations gain nothing
  bool converged = false;   ///< it is near its minimum, and plausible
  bool determined = false;  ///< it has converged, and its uncertainty is small enough
  bool ambiguous = false;   ///< another scale explains the window about as well
  float length = 0;         ///< RMS distance of the keyframes from the first one, m
};

/// What carries over from one iteration to the next.
template <class P>
struct AlignmentState {
  typename P::F32 lambda;         ///< damping
  typename P::F32 inverse_depth;  ///< mean over the landmarks, 1/m
};

/// One iteration on a snapshot of at least two keyframes; changes poses, velocities and points of
/// `window.state`, and `window.bias`. Position and heading of the first keyframe stay. Landmarks
/// that no position explains, or whose distance is unknown, are marked as lost.
/// @param afresh  forgets what has been found: no velocity, no biases, gravity opposes the mean
///                force, all landmarks at the mean inverse depth
/// Must run in a stage of `fc`, whose local memory it uses for some tens of kB, freed on return.
template <class P>
AlignmentReport align_once(work::Machine& fc, Window<P>& window, AlignmentState<P>& state,
                           const OptimiserOptions& optimiser, const AlignmentOptions& options,
                           bool afresh);

/// Iterates from the present state and from landmarks at several distances, and keeps what explains
/// the window best. From one start alone the scale may end in another minimum, since distances and
/// velocity can be traded for each other and the gyro's bias.
/// @return as of the iteration that is kept; not determined if a solution of another scale explains
///         the window about as well
template <class P>
AlignmentReport align_from_all(work::Machine& fc, Window<P>& window, AlignmentState<P>& state,
                               const OptimiserOptions& optimiser, const AlignmentOptions& options);

}  // namespace leviosim::vio
