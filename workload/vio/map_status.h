// The state of the map beside the pose graph, shared by front end and back end.
#pragma once

namespace leviosim::vio {

/// How well the estimate explains a window: mean squares of whitened residuals, which are 1 or less
/// if the noise is as assumed.
struct WindowFit {
  float visual = 0;    ///< of the observations
  float inertial = 0;  ///< of the IMU terms
  float prior = 0;     ///< of the marginalisation prior; negative away from the prior's minimum
  /// Standard deviation of the scale, as a share of it: of the alignment, then of the last full
  /// window with little damping.
  float scale_sigma = 0;
  bool solved = true;    ///< the last iteration's system could be factored
  float accel_bias = 0;  ///< accelerometer bias, in standard deviations of its prior
};

struct MapStatus {
  /// Velocity, gravity and scale are known: from rest, or from the initialisation. Before an
  /// initialisation landmarks have no depth.
  bool aligned = false;
  /// The initialisation has converged once, from more than AlignmentOptions::few_keyframes, to a
  /// plausible solution, though it may be uncertain.
  bool converged = false;
  /// Mean inverse depth of the landmarks as the alignment has it [1/m]; 0 before there is one.
  float inverse_depth = 0;
  WindowFit fit;  ///< of the last window since the alignment
};

}  // namespace leviosim::vio
