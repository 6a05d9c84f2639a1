// Colours of a value from 0 to a maximum: blue, teal, amber, red, all dark enough to be seen on
// white.
#pragma once

#include <string>

namespace leviosim::tools::plot {

/// How many different colours the scale has.
constexpr int kColours = 24;

/// 0 ... kColours - 1, in equal parts of [0, max]; the ends for values outside, 0 if max is 0.
int colour_index(double value, double max);

/// "#rrggbb".
std::string colour(int index);

}  // namespace leviosim::tools::plot
