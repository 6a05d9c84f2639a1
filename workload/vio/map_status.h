// What front end and back end tell each other about the map beside the pose graph.
#pragma once

namespace leviosim::vio {

struct MapStatus {
  /// Velocity, gravity and scale are known: from rest, or from the initialisation. Until then a map
  /// that has an initialisation has landmarks without a distance.
  bool aligned = false;
  /// The initialisation has once converged to what can be true, though it may be uncertain.
  bool converged = false;
  /// Of what is seen, 1/m, as the alignment has it; 0 before there is one.
  float inverse_depth = 0;
};

}  // namespace leviosim::vio
