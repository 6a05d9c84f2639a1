// One line of a comparison with measured hardware: what was measured or derived elsewhere, and what
// the simulator says.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "tools/app/table/banded.h"
#include "tools/app/validation/references.h"

namespace leviosim::tools {

struct MicrobenchRow {
  std::string group;  ///< heading under which it is shown
  std::string name;
  int cores = 1;
  std::string unit;
  double reference = 0;       ///< or the low end of what the sources allow
  double reference_high = 0;  ///< the same as reference where they agree
  double simulated = 0;
  std::optional<Banded> band = std::nullopt;  ///< band of the simulated value
  double tolerance = 0.05;                    ///< largest error that is accepted, relative
  /// Of a row that is known to miss it: the error that it may not exceed.
  std::optional<double> guard = std::nullopt;
  int tier = 1;  ///< 1: behaviour of a unit; 2: includes what a compiler does
  std::string source;

  /// Relative distance from the reference, or from the nearest end of its range; 0 inside.
  double error() const {
    const double nearest = std::clamp(simulated, reference, reference_high);
    return (simulated - nearest) / nearest;
  }
  /// Whether the reference lies in the band, or some of its range does.
  bool is_inside() const { return band && band->low <= reference_high && reference <= band->high; }
  bool met() const { return std::abs(error()) <= tolerance; }
  Verdict verdict() const { return judge(error(), tolerance, guard); }
};

}  // namespace leviosim::tools
