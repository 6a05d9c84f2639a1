// Between the representation that all parameters have in common (Field::set: a double) and members
// of a chip; and limits of what more than one section has.
#pragma once

#include <cstdint>
#include <type_traits>

#include "sim/base/units.h"

namespace leviosim::platform {

/// Clocks beyond these are typing errors; far outside of any chip of this class. Hertz.
inline constexpr double kMinClock = 1e3;
inline constexpr double kMaxClock = 1e11;

/// And sizes beyond this, in thousands of gate equivalents.
inline constexpr double kMaxGates = 1e6;

/// Numbers, switches (on unless 0) and enumerators by their value.
template <class T>
requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void put(T& target, double value) {
  if constexpr (std::is_same_v<T, bool>)
    target = value != 0;
  else
    target = static_cast<T>(value);
}
template <class Tag, class Rep>
void put(Quantity<Tag, Rep>& target, double value) {
  target = Quantity<Tag, Rep>(static_cast<Rep>(value));
}

template <class T>
requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) double as_number(T value) {
  return static_cast<double>(value);
}
template <class Tag, class Rep>
double as_number(Quantity<Tag, Rep> value) {
  return static_cast<double>(value.count());
}

}  // namespace leviosim::platform
