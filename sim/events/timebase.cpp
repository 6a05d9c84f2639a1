#include "sim/events/timebase.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/events/last_time.h"

namespace leviosim::sim {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

std::optional<std::int64_t> multiply(std::int64_t a, std::int64_t b) {
  std::int64_t product = 0;
  if (__builtin_mul_overflow(a, b, &product)) return std::nullopt;
  return product;
}

/// Rounds towards minus infinity; `divisor` > 0.
std::int64_t floor_divide(std::int64_t value, std::int64_t divisor) {
  return value / divisor - (value % divisor < 0 ? 1 : 0);
}

std::string listed(const std::vector<ClockSpec>& clocks) {
  std::string text;
  for (const ClockSpec& clock : clocks)
    text +=
        fmt::format("{}{} {} Hz", text.empty() ? "" : ", ", clock.name, clock.frequency.count());
  return text;
}

void refuse_bad_clocks(const std::vector<ClockSpec>& clocks) {
  for (auto clock = clocks.begin(); clock != clocks.end(); ++clock) {
    if (clock->name.empty()) throw InputError("a clock has no name");
    if (clock->frequency <= Hertz(0))
      throw InputError(fmt::format("clock '{}': frequency {} Hz, expected a positive number",
                                   clock->name, clock->frequency.count()));
    const auto same_name = [&](const ClockSpec& other) { return other.name == clock->name; };
    if (std::any_of(clocks.begin(), clock, same_name))
      throw InputError(fmt::format("clock '{}' is given twice", clock->name));
  }
}

std::int64_t common_ticks_per_second(const std::vector<ClockSpec>& clocks) {
  std::int64_t ticks = kNanosecondsPerSecond;
  for (const ClockSpec& clock : clocks) {
    const std::int64_t frequency = clock.frequency.count();
    const auto common = multiply(ticks / std::gcd(ticks, frequency), frequency);
    if (!common || *common > Timebase::kMaxTicksPerSecond)
      throw InputError(
          fmt::format("no exact time base for the clocks {} together with 1 ns: their common tick "
                      "rate exceeds {} Hz, the most for which 64 bits last an hour; use rounder "
                      "frequencies, for instance whole megahertz",
                      listed(clocks), Timebase::kMaxTicksPerSecond));
    ticks = *common;
  }
  return ticks;
}

}  // namespace

ClockDomain::ClockDomain(std::string name, Hertz frequency, Duration period)
    : name_(std::move(name)), frequency_(frequency), period_(period) {
  check(period > Duration(0), "a clock period is at least one tick");
}

Duration ClockDomain::duration(Cycles cycles) const {
  const auto ticks = multiply(cycles.count(), period_.count());
  if (!ticks || Duration(*ticks) > kLongestDuration) fail_beyond_time();
  return Duration(*ticks);
}

Cycles ClockDomain::whole_cycles(Duration duration) const {
  check(duration >= Duration(0), "a duration is negative");
  return Cycles(duration.count() / period_.count());
}

Timebase::Timebase(const std::vector<ClockSpec>& clocks) : ticks_per_second_(0) {
  refuse_bad_clocks(clocks);
  ticks_per_second_ = common_ticks_per_second(clocks);
  clocks_.reserve(clocks.size());
  for (const ClockSpec& clock : clocks)
    clocks_.emplace_back(clock.name, clock.frequency,
                         Duration(ticks_per_second_ / clock.frequency.count()));
}

const ClockDomain& Timebase::clock(std::string_view name) const {
  std::string known;
  for (const ClockDomain& clock : clocks_) {
    if (clock.name() == name) return clock;
    known += (known.empty() ? "" : ", ") + clock.name();
  }
  throw InputError(fmt::format("unknown clock '{}'; the clocks are: {}", name, known));
}

Duration Timebase::from_nanoseconds(std::int64_t nanoseconds) const {
  const auto ticks = multiply(nanoseconds, ticks_per_second_ / kNanosecondsPerSecond);
  if (!ticks)
    throw InputError(
        fmt::format("{} ns is outside the simulated range of {:.0f} s; timestamps must be relative "
                    "to the start",
                    nanoseconds, seconds(Time::max() - Time{})));
  return Duration(*ticks);
}

std::int64_t Timebase::whole_nanoseconds(Duration duration) const {
  return floor_divide(duration.count(), ticks_per_second_ / kNanosecondsPerSecond);
}

double Timebase::seconds(Duration duration) const {
  return static_cast<double>(duration.count()) / static_cast<double>(ticks_per_second_);
}

}  // namespace leviosim::sim
