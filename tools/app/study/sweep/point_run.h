// The result of one point: what a run or a replay says, as a list of figures.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/study/sweep/points.h"

namespace leviosim::tools {

struct SweepFigure {
  std::string name;
  std::string unit;
  std::string description;
  double value = 0;
};

struct PointResult {
  std::string failure;  ///< why the point cannot be run to its end, such as too little L1
  std::vector<SweepFigure> figures;
};

/// What sweeps are judged by, first of all figures; less is better. A figure is missing where it
/// does not exist: energy of chips without energy figures, the error without ground truth or where
/// the algorithm would have computed something else than was recorded.
struct Objective {
  const char* figure;
  const char* unit;
  const char* title;  ///< of a column
  int decimals;
  double scale;  ///< for the column
};
inline constexpr std::array kObjectives{
    Objective{"objective.latency", "ms", "latency ms", 3, 1},
    Objective{"objective.energy", "mJ", "energy mJ", 4, 1},
    Objective{"objective.l1_peak", "byte", "L1 peak kB", 1, 1e-3},
    Objective{"objective.ate", "m", "ATE m", 4, 1}};

/// Computes the point, or times its recorded work. A chip too small for the work is a failure.
/// @throws Interrupted
PointResult run_point(const ResolvedPoint& point);

/// As JSON with every bit of the numbers.
std::string to_text(const PointResult& result);
/// Nothing for what to_text() never wrote.
std::optional<PointResult> parse_point_result(std::string_view text);

}  // namespace leviosim::tools
