// Where simulated time ends: what 64 bits of ticks can count, which is an hour at the least. Work
// that takes longer is refused, since sums of times would overflow.
#pragma once

#include <cmath>
#include <cstdint>

#include "sim/base/error.h"
#include "sim/base/units.h"
#include "sim/events/timebase.h"

namespace leviosim::sim {

/// Nothing happens later; and no duration is longer than half of it, so no sum of the two
/// overflows.
inline constexpr Time kLastTime{std::int64_t{1} << 62};
inline constexpr Duration kLongestDuration{std::int64_t{1} << 61};

[[noreturn]] inline void fail_beyond_time() {
  throw InputError(
      "the work takes longer in simulated time than 64 bits of clock ticks can count: there is too "
      "much of it, or the frequencies of the clocks have no common multiple that is low");
}

/// Cycles that were computed as a whole number. @throws InputError if they are too many to count
inline Cycles counted_cycles(double cycles) {
  if (!(std::abs(cycles) < static_cast<double>(kLongestDuration.count()))) fail_beyond_time();
  return Cycles(static_cast<std::int64_t>(cycles));
}

/// So many cycles later. @throws InputError for more than can be counted
inline Cycles later(Cycles instant, Cycles by) {
  const Cycles sum = instant + by;  // of two that are no longer than this one may be
  if (sum.count() > kLongestDuration.count()) fail_beyond_time();
  return sum;
}

}  // namespace leviosim::sim
