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

}  // namespace leviosim::traces
