// The picture of a tuning: error, missed frames and power over the clock, a colour per frame rate.
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/tune/tuning.h"

namespace leviosim::tools {

/// A file of SVG. Errors, on a logarithmic axis, and missed frames are points: of every seed, and
/// their medians; a cross is a median that diverged. Power is a line of medians in its band,
/// interrupted where the chip has no energies. Dashed lines are the limits; rings are the lowest
/// clocks that are enough.
std::string tune_plot(const TunePlan& plan, const std::vector<TunePoint>& points,
                      const std::vector<Choice>& choices);

}  // namespace leviosim::tools
