// The scale of an estimate, window after window: how long its path is over that of the truth. A
// monocular estimate may have the right scale on average and wander about it, which one alignment
// of the whole hides. Left out: windows in which the truth hardly moves, since they say nothing.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "traces/trajectories/evaluation.h"

namespace leviosim::traces {

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
