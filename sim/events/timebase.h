// Exact simulated time over several clock domains.
//
// Models: time as a whole number of ticks. 370 MHz is no whole number of picoseconds, so the tick
// is not a fixed unit: a Timebase chooses ticks per second as the least common multiple of all
// clock frequencies and 1e9, and so a cycle of every clock and a nanosecond (the unit of sensor
// timestamps) are whole numbers of ticks. Conversions never round unless their name says so.
// GAP9 with 370 MHz, 240 MHz and nanoseconds: 222e9 ticks per second.
//
// Leaves out: phase between clocks (every clock has an edge at time 0), jitter, and clocks that
// change frequency during a run.
#pragma once

#include <compare>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/units.h"

namespace leviosim::sim {

using Duration = Quantity<struct DurationTag, std::int64_t>;  ///< ticks of the Timebase at hand

/// A point in simulated time: whole ticks since the start of the simulation.
struct Time {
  std::int64_t ticks = 0;

  static constexpr Time max() { return {std::numeric_limits<std::int64_t>::max()}; }
  friend constexpr auto operator<=>(Time, Time) = default;
  friend constexpr Time operator+(Time t, Duration d) { return {t.ticks + d.count()}; }
  friend constexpr Time operator-(Time t, Duration d) { return {t.ticks - d.count()}; }
  friend constexpr Duration operator-(Time a, Time b) { return Duration(a.ticks - b.ticks); }
};

/// One clock: a name, a frequency, and its period as a whole number of ticks.
class ClockDomain {
 public:
  ClockDomain(std::string name, Hertz frequency, Duration period);

  const std::string& name() const { return name_; }
  Hertz frequency() const { return frequency_; }
  Duration period() const { return period_; }

  /// Length of `cycles` cycles; exact. @throws InputError beyond kLongestDuration
  Duration duration(Cycles cycles) const;
  /// Whole cycles contained in a duration >= 0: rounded down.
  Cycles whole_cycles(Duration duration) const;

 private:
  std::string name_;
  Hertz frequency_;
  Duration period_;
};

/// What a Timebase is built from.
struct ClockSpec {
  std::string name;
  Hertz frequency;
};

class Timebase {
 public:
  /// Bound on ticks per second: an int64 of ticks lasts at least one hour.
  static constexpr std::int64_t kMaxTicksPerSecond =
      std::numeric_limits<std::int64_t>::max() / 3600;

  /// Throws InputError for a frequency that is not positive, for a repeated or empty name, and when
  /// the common tick of all clocks would exceed kMaxTicksPerSecond.
  explicit Timebase(const std::vector<ClockSpec>& clocks);

  const std::vector<ClockDomain>& clocks() const { return clocks_; }
  /// Throws InputError for an unknown name, listing the known ones.
  const ClockDomain& clock(std::string_view name) const;

  /// Exact. Throws InputError when it does not fit in 64 bits of ticks: absolute sensor timestamps
  /// (EuRoC counts from 1970) must be made relative to the first one.
  Duration from_nanoseconds(std::int64_t nanoseconds) const;
  /// Rounded down; exact for every duration that came from nanoseconds.
  std::int64_t whole_nanoseconds(Duration duration) const;
  /// For printing only: not exact.
  double seconds(Duration duration) const;

 private:
  std::int64_t ticks_per_second_;
  std::vector<ClockDomain> clocks_;
};

}  // namespace leviosim::sim
