// Relative errors over sub-trajectories of a given length (Geiger et al., "Are we ready for
// autonomous driving? The KITTI vision benchmark suite", 2012; Zhang and Scaramuzza 2018): drift
// per distance, whatever the alignment. Every matched pose from which the true path goes on for the
// length starts one; it ends at the first matched pose that is at least so far along the true path
// (evaluation.h). Its error is E = inverse(gt_rel) * est_rel, where gt_rel and est_rel take the
// pose at its end to the frame of the pose at its start: the translation of E over the length, and
// the rotation angle of E over the length. The estimate is the aligned one, which matters for Sim3
// only: its scale is applied. Left out: gaps in the estimate. Behind one, a sub-trajectory may be
// longer than its name says.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "traces/trajectories/evaluation.h"

namespace leviosim::traces {

struct RelativeErrors {
  double length_m = 0;
  std::size_t count = 0;            ///< of sub-trajectories; 0 if the path is too short
  ErrorSummary translation;         ///< [%] of the length
  ErrorSummary rotation_deg_per_m;  ///< [deg/m]
};

/// `length_m` is above 0.
RelativeErrors relative_errors(const Evaluation& evaluation, double length_m);

// What an estimate has drifted by when the flight ends: how far its last positions lie from the
// truth if its first ones lie on it. Loop closure is about this error; an alignment of the whole
// flight hides it.

struct EndDrift {
  double aligned_share = 0.05;       ///< of the true path, from its start on
  double shortest_aligned_path = 1;  ///< with less of a path the heading is not known [m]
  double last_s = 1;                 ///< over which positions are averaged
};

/// Distance between the mean of the last estimated positions and that of the true ones, after an
/// alignment of position and yaw over the beginning [m]. None if the beginning is too short for
/// that. For poses with time stamps.
std::optional<double> end_drift(const Evaluation& evaluation, const EndDrift& how = {});

// How far estimated attitudes lie from the true ones, after an alignment of their own: the one that
// ATE is given after is found from positions alone, and says little about rotations where the
// positions are wrong or lie on a line. The truth's z axis is taken for the vertical.
// Left out: an offset between the bodies of estimate and truth.

struct AttitudeErrors {
  /// Largest angle between the vertical of an estimate that knows gravity and the true one. [deg]
  static constexpr double kVerticalWithin = 5;

  double tilt_rmse_deg = 0;     ///< of the vertical
  double heading_rmse_deg = 0;  ///< about the vertical
  std::vector<double> tilts_deg;     ///< of each pose, from 0
  std::vector<double> headings_deg;  ///< of each pose, from -180 to 180
  double world_tilt_deg = 0;    ///< between the z axes of the estimate's world and of the truth's

  bool is_gravity_aligned() const { return world_tilt_deg <= kVerticalWithin; }
};

/// The rotation that brings the estimated attitudes closest to the true ones (least squares over
/// their matrices) is applied first. Absent where the evaluation holds no poses.
std::optional<AttitudeErrors> attitude_errors(const Evaluation& evaluation);

// The scale of an estimate, window after window: how long its path is over that of the truth. A
// monocular estimate may have the right scale on average and wander about it, which one alignment
// of the whole hides. Left out: windows in which the truth hardly moves, since they say nothing.

struct ScaleWindows {
  double window_s = 5;
  double shortest_path_m = 1;  ///< of the truth in a window that counts
};

/// Scale of the estimate over the truth in each window that counts: the factor which brings the
/// true positions closest to the estimated ones (evaluation.h). Windows follow one another from the
/// first matched pose on. What is left at the end is dropped, but a flight that is shorter than a
/// window is one as a whole. Whatever scale the evaluation applied is taken back. For poses with
/// time stamps.
std::vector<double> scales_in_windows(const Evaluation& evaluation, const ScaleWindows& how = {});

/// Over windows.
struct ScaleSummary {
  std::size_t windows = 0;
  std::optional<double> mean;   ///< none without a window
  std::optional<double> sigma;  ///< standard deviation of a sample; none of fewer than two windows
};
ScaleSummary summarize_scales(const std::vector<double>& scales);

}  // namespace leviosim::traces
