// How far an estimated trajectory lies from the ground truth: absolute trajectory error (ATE; Sturm
// et al. 2012, Zhang and Scaramuzza 2018). The truth is interpolated at the stamps of the estimate,
// the estimate is aligned, the differences are summed up.
// A figure is worth nothing without its protocol, so the result carries it as one line.
// Left out: relative errors (trajectory_errors.h), time-offset estimation.
#pragma once

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "traces/datasets/dataset.h"
#include "traces/trajectories/association.h"
#include "traces/trajectories/trajectory.h"
#include "traces/trajectories/trajectory_alignment.h"

namespace leviosim::traces {

/// Throws InputError if the accuracy of poses at these times is unknown: there is ground truth,
/// but fewer than three stamps have a true pose that is close enough (EvaluationOptions). Passes
/// where there is no truth, or fewer than three stamps.
/// @param file  of the truth, for the message
void require_truth_at(const Trajectory& truth, const std::filesystem::path& file,
                      const std::vector<std::int64_t>& stamps_ns);

/// What the stamps of both trajectories are.
enum class Stamps {
  time,         ///< nanoseconds
  pose_number,  ///< 0, 1, 2, …: files without time stamps, whose poses are matched by their number
};

struct EvaluationOptions {
  Alignment alignment = Alignment::se3;
  /// An estimate is matched if a sample of the truth lies this close in time. [ns]
  std::int64_t max_gap_ns = 10'000'000;
  /// How many poses a complete estimate would have, e.g. the frames that were fed in. 0: not known.
  std::size_t expected_poses = 0;
  Stamps stamps = Stamps::time;
};

struct ErrorSummary {
  double rmse = 0;
  double mean = 0;
  double median = 0;  ///< the mean of the middle two for an even number
  double max = 0;
};

/// All zero for no values.
ErrorSummary summarize(std::vector<double> errors);

/// Distance between the positions [m].
double translation_error(const MatchedPose& pose);
/// Angle between the rotations [deg].
double rotation_error_deg(const MatchedPose& pose);
/// The angle of a rotation, 0 to 180. [deg]
double angle_deg(const Eigen::Matrix3d& rotation);

struct Evaluation {
  ErrorSummary translation;      ///< [m]
  double rotation_rmse_deg = 0;  ///< of the angle between aligned estimate and truth
  Similarity alignment;          ///< from the estimate's world to that of the truth
  std::size_t matched = 0;
  std::size_t estimates = 0;
  /// How much of the flight has an estimate. Matched poses over expected poses where those are
  /// known (at most 1 for an honest expectation); else the time from the first to the last matched
  /// pose over the duration of the truth, or matched over true poses if there is no time.
  double completion = 0;
  std::optional<double> longest_gap_s;  ///< between successive matched poses; none without time
  double path_length_m = 0;             ///< of the truth from the first to the last matched pose
  /// Of the estimate, as it was estimated, over the truth: RMS distances of the matched positions
  /// from their mean. Absent where the truth does not move. Without guesses where they are known.
  std::optional<double> size_ratio;
  /// RMSE of the positions without the poses that are guesses, before there was a map [m].
  /// evaluate() leaves it to those who know which they are; absent if there are none.
  std::optional<double> located_rmse_m;
  std::string protocol;             ///< one line that belongs beside every figure above
  std::vector<MatchedPose> poses;   ///< all that matched, the estimate aligned
  std::vector<double> distances_m;  ///< of each along the true path, from the first
};

/// Throws InputError if nothing matches or too little for the alignment, and NotComparable if the
/// coordinates are NaN or too large to be compared.
Evaluation evaluate(const Trajectory& estimate, const Trajectory& truth,
                    const EvaluationOptions& options = {});

}  // namespace leviosim::traces
