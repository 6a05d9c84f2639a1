// What the accelerometer of a recording reads while nothing moves, which is gravity.
#pragma once

#include <optional>

#include "traces/datasets/dataset.h"

namespace leviosim::traces {

/// Size of the mean acceleration over the quietest second. [m/s²]
/// @returns nothing if there is no second in which the body neither turns nor shakes
std::optional<double> gravity_at_rest(const Dataset& data);

}  // namespace leviosim::traces
