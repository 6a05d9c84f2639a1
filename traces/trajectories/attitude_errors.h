// How far estimated attitudes lie from the true ones, after an alignment of their own: the one that
// ATE is given after is found from positions alone, and says little about rotations where the
// positions are wrong or lie on a line. The truth's z axis is taken for the vertical.
// Left out: an offset between the bodies of estimate and truth.
#pragma once

#include <optional>
#include <vector>

#include "traces/trajectories/evaluation.h"

namespace leviosim::traces {

struct AttitudeErrors {
  /// Largest angle between the vertical of an estimate that knows gravity and the true one. [deg]
  static constexpr double kVerticalWithin = 5;

  double tilt_rmse_deg = 0;          ///< of the vertical
  double heading_rmse_deg = 0;       ///< about the vertical
  std::vector<double> tilts_deg;     ///< of each pose, from 0
  std::vector<double> headings_deg;  ///< of each pose, from -180 to 180
  double world_tilt_deg = 0;  ///< between the z axes of the estimate's world and of the truth's

  bool is_gravity_aligned() const { return world_tilt_deg <= kVerticalWithin; }
};

/// The rotation that brings the estimated attitudes closest to the true ones (least squares over
/// their matrices) is applied first. Absent where the evaluation holds no poses.
std::optional<AttitudeErrors> attitude_errors(const Evaluation& evaluation);

}  // namespace leviosim::traces
