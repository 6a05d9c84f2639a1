// What a sweep keeps of a point: all that a run or a replay says, as a list of figures.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "tools/app/comparison/record_source.h"
#include "tools/app/study/outcome.h"
#include "tools/app/study/sweep/points.h"

namespace leviosim::tools {

/// What sweeps are judged by, first of all figures; less is better. A figure is missing where it
/// does not exist: energy and area of chips without such figures, the error without ground truth or
/// where the algorithm would have computed something else than was recorded.
struct Objective {
  const char* figure;
  const char* unit;
  const char* title;  ///< of a column
  int decimals;
  double scale;  ///< for the column
};
inline constexpr std::array kObjectives{
    Objective{"objective.frame_time", "ms", "frame ms", 3, 1},
    Objective{"objective.energy", "mJ", "energy mJ", 4, 1},
    Objective{"objective.l1_peak", "byte", "L1 peak kB", 1, 1e-3},
    Objective{"objective.ate", "m", "ATE m", 4, 1},
    Objective{"objective.area", "mm2", "area mm2", 3, 1}};

/// Computes the point, or times its recorded work. A chip too small for the work is a failure.
/// @param for_budget  keeps also what limits of budgets may be about besides: frame.*, the peaks of
///                    L1 and L2, operations of stages
/// @throws Interrupted
Outcome run_point(const ResolvedPoint& point, bool for_budget = false);

// A point of a finished sweep as a run that can be compared: "swept:3". A sweep keeps figures only,
// not where cycles went, so the point is replayed or computed again, as the sweep's plan says.

/// "swept:3", where `swept` is the folder of a sweep.
struct PointName {
  std::string sweep;
  std::string number;  ///< as typed

  std::string text() const { return sweep + ':' + number; }
};

/// Nothing for all else, such as a folder that is called so.
/// @throws InputError for a sweep without a number, saying which there are
std::optional<PointName> point_name(const std::string& text);

/// @param memory,quiet  of the options; the chip is the point's
/// @param files         gets what a run folder would hold; may be null
/// @throws InputError for a number that the sweep does not have, for points whose plan, trace or
///         data are no longer what they were, and as the run does
RunRecord read_point(const PointName& name, const RecordOptions& options,
                     RunFiles* files = nullptr);

}  // namespace leviosim::tools
