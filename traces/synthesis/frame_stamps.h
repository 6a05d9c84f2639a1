// Choosing the times at which a camera takes its frames. All stamps are nanoseconds and rise.
#pragma once

#include <cstdint>
#include <vector>

namespace leviosim::traces {

using StampList = std::vector<std::int64_t>;

struct TimeSpan {
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;  ///< inclusive
};

/// begin, begin + 1 / rate, ... up to end.
StampList regular_stamps(std::int64_t begin_ns, std::int64_t end_ns, double rate_hz);

StampList stamps_within(const StampList& stamps, TimeSpan span);

/// The first of the grid's stamps in the span and then, for each further period, the nearest one:
/// a camera that is triggered by the clock of another sensor.
StampList stamps_nearest_to_period(const StampList& grid, TimeSpan span, std::int64_t period_ns);

}  // namespace leviosim::traces
