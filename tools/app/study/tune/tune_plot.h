// The picture of a tuning: error, missed frames and power over the clock, a line per frame rate.
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/tune/tuning.h"

namespace leviosim::tools {

/// A file of SVG, of medians. What a point is without (an error where the estimate diverged, which
/// a cross says; power where the chip has no energies) interrupts its line. Errors are on a
/// logarithmic axis. Dashed lines are the limits; rings are the lowest clocks that are enough.
std::string tune_plot(const TunePlan& plan, const std::vector<TunePoint>& points,
                      const std::vector<Choice>& choices);

}  // namespace leviosim::tools
