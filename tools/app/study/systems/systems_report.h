// Published systems beside what leviosim predicts, as a table, as CSV and as a picture of power
// over frame rate.
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/systems/predictions.h"

namespace leviosim::tools {

/// Milli-units in a unit: power is shown in mW, energy in mJ.
inline constexpr double kMilli = 1e3;

/// A row per system, how to read it, and the sources.
std::string systems_table(const std::vector<SystemRow>& rows);

/// How many are modelled, and the one that takes the least energy per frame, in a sentence.
std::string systems_conclusion(const std::vector<SystemRow>& rows);

/// The rows of systems_table() with all digits, as CSV.
std::string systems_csv(const std::vector<SystemRow>& rows);

/// A file of SVG with logarithmic axes: dots are published, rings predicted with the band of their
/// power, an arrow points below a bound. Lines join points of equal energy per frame. Systems
/// without a rate or a power are left out.
std::string systems_plot(const std::vector<SystemRow>& rows);

}  // namespace leviosim::tools
