// What an estimate has drifted by when the flight ends: how far its last positions lie from the
// truth if its first ones lie on it. Loop closure is about this error; an alignment of the whole
// flight hides it.
#pragma once

#include <optional>

#include "traces/trajectories/evaluation.h"

namespace leviosim::traces {

struct EndDrift {
  double aligned_share = 0.05;       ///< of the true path, from its start on
  double shortest_aligned_path = 1;  ///< with less of a path the heading is not known [m]
  double last_s = 1;                 ///< over which positions are averaged
};

/// Distance between the mean of the last estimated positions and that of the true ones, after an
/// alignment of position and yaw over the beginning [m]. None if the beginning is too short for
/// that. For poses with time stamps.
std::optional<double> end_drift(const Evaluation& evaluation, const EndDrift& how = {});

}  // namespace leviosim::traces
