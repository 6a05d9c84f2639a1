// Whether the map of a run is plainly wrong, so that its trajectory and all that depends on it is
// worth little: what the end of a run warns of. Left out: maps that are merely inaccurate.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/app/result/run_result.h"

namespace leviosim::tools {

/// Beyond these a map is plainly wrong. Drift of published estimators is 1 % of the path or less,
/// and a scale within a few per cent.
struct MapLimits {
  double error_share = 0.1;     ///< ATE over the length of the true path
  double scale = 1.25;          ///< of the estimate over the truth, or the truth over it
  double kept_s = 2;            ///< that the pose may be kept, frame after frame
  double initialising_s = 5;    ///< that the initialisation may take
  double restarts_per_s = 0.2;  ///< of the map, where there are more than two
  double shortest_path_m = 1;   ///< on which error and scale say something
};

/// Over all frames.
std::int64_t map_restarts(const RunResult& run);

/// "the error is 21.3 % of the path", one text for each fault that a run shows; none for a run
/// whose map may be right. Without ground truth only the poses tell. A replay evaluates nothing,
/// so it does not know the scale.
std::vector<std::string> map_faults(const RunResult& run, const MapLimits& limits = {});

}  // namespace leviosim::tools
