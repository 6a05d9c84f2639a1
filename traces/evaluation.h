// How far an estimated trajectory lies from the ground truth: absolute trajectory error (ATE; Sturm
// et al. 2012, Zhang and Scaramuzza 2018). The truth is interpolated at the stamps of the estimate
// (positions linearly, rotations by slerp), the estimate is aligned, the differences are summed up.
// A figure is worth nothing without its protocol, so the result carries it as one line.
// Left out: relative errors over sub-trajectories, time-offset estimation.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "traces/alignment.h"
#include "traces/trajectory.h"

namespace leviosim::traces {

struct EvaluationOptions {
  Alignment alignment = Alignment::se3;
  /// An estimate is matched if a sample of the truth lies this close in time. [ns]
  std::int64_t max_gap_ns = 10'000'000;
  /// How many poses a complete estimate would have, e.g. the frames that were fed in. 0: as many as
  /// the estimate has.
  std::size_t expected_poses = 0;
};

/// An estimated pose and the true pose at its time, both of the body frame.
struct MatchedPose {
  std::int64_t t_ns = 0;
  Eigen::Isometry3d estimate = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
};

/// Matches every pose of the estimate that lies within the span of the truth and no farther than
/// `max_gap_ns` from its nearest sample. The truth is never extrapolated.
std::vector<MatchedPose> associate(const Trajectory& estimate, const Trajectory& truth,
                                   std::int64_t max_gap_ns);

struct ErrorSummary {
  double rmse = 0;
  double mean = 0;
  double median = 0;  ///< the mean of the middle two for an even number
  double max = 0;
};

/// All zero for no values.
ErrorSummary summarize(std::vector<double> errors);

struct Evaluation {
  ErrorSummary translation;      ///< [m]
  double rotation_rmse_deg = 0;  ///< of the angle between aligned estimate and truth
  Similarity alignment;          ///< from the estimate's world to that of the truth
  std::size_t matched = 0;
  std::size_t estimates = 0;
  double completion = 0;     ///< matched / expected, at most 1 for an honest expectation
  double path_length_m = 0;  ///< of the truth from the first to the last matched pose
  std::string protocol;      ///< one line that belongs beside every figure above
};

/// Throws InputError if nothing matches or too little for the alignment.
Evaluation evaluate(const Trajectory& estimate, const Trajectory& truth,
                    const EvaluationOptions& options = {});

}  // namespace leviosim::traces
