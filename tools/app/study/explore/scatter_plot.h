// The picture of an exploration, as the paper's figure has it: the absolute over the relative error
// of every point, on logarithmic axes. Colours are profiles, shapes are sequences; the profile as
// it is has a dark outline.
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/explore/exploration.h"

namespace leviosim::tools {

/// A file of SVG. Points whose runs diverged, or that lie beyond 1000 % of relative error, are left
/// out and counted below the heading.
std::string scatter_plot(const BatchPlan& plan, const std::vector<ExploredPoint>& explored);

}  // namespace leviosim::tools
