// What a sweep keeps of a point: all that a run or a replay says, as a list of figures.
#pragma once

#include <array>

#include "tools/app/record/record.h"
#include "tools/app/study/sweep/points.h"

namespace leviosim::tools {

/// What sweeps are judged by, first of all figures; less is better. A figure is missing where it
/// does not exist: energy and area of chips without such figures, the error without ground truth or
/// where the algorithm would have computed something else than was recorded.
struct Objective {
  const char* figure;
  const char* unit;
  const char* description;
  const char* statistic;  ///< that it is
  double factor;          ///< from the statistic's unit
  const char* title;      ///< of a column
  const char* shown_unit;
  int decimals;
  double scale;  ///< from the unit to the shown one
};
inline constexpr std::array kObjectives{
    Objective{"objective.frame_time", "ms", "mean over all frames, each by itself",
              "frame.time.mean", 1e-6, "frame", "ms", 3, 1},
    Objective{"objective.energy", "mJ", "per frame, idle time included", "energy.frame", 1,
              "energy", "mJ", 4, 1},
    Objective{"objective.l1_peak", "byte", "highest of the cluster's stages", "memory.l1.peak", 1,
              "L1 peak", "kB", 1, 1e-3},
    Objective{"objective.ate", "m", "RMSE of the trajectory", "accuracy.ate.rmse", 1, "ATE", "m", 4,
              1},
    Objective{"objective.area", "mm2", "of the chip, without pads and analogue parts", "area.chip",
              1, "area", "mm2", 3, 1}};

/// Computes the point, or times its recorded work. A chip too small for the work is a failure.
/// @throws Interrupted
RunRecord run_point(const ResolvedPoint& point, KnownRuns& known);

}  // namespace leviosim::tools
