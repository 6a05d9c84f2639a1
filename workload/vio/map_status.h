// What front end and back end tell each other about the map beside the pose graph.
#pragma once

namespace leviosim::vio {

/// How well what was found explains a window: mean squares of whitened residuals, of which noise as
/// it is assumed leaves 1 or less.
struct WindowFit {
  float visual = 0;
  float inertial = 0;
  float prior = 0;  ///< of the past; less than nothing where the prior's minimum lies elsewhere
  /// Standard deviation of the scale of the positions, as a share of it: the alignment's, then that
  /// of the last full window that was hardly damped.
  float scale_sigma = 0;
  bool solved = true;    ///< the last iteration's system could be factored
  float accel_bias = 0;  ///< in standard deviations of what is known of it beforehand
};

struct MapStatus {
  /// Velocity, gravity and scale are known: from rest, or from the initialisation. Until then a map
  /// that has an initialisation has landmarks without a distance.
  bool aligned = false;
  /// The initialisation has once converged, from more than few keyframes, to what can be true,
  /// though it may be uncertain.
  bool converged = false;
  /// Of what is seen, 1/m, as the alignment has it; 0 before there is one.
  float inverse_depth = 0;
  WindowFit fit;  ///< of the last window since the alignment
};

}  // namespace leviosim::vio
