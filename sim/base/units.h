// Quantities as types, so that cycles are never added to bytes. Each wraps one number in the unit
// its name says; arithmetic stays within one quantity, and scaling is by plain numbers.
#pragma once

#include <compare>
#include <cstdint>

namespace leviosim {

template <class Tag, class Rep>
class Quantity {
 public:
  constexpr Quantity() = default;
  constexpr explicit Quantity(Rep count) : count_(count) {}
  constexpr Rep count() const { return count_; }

  constexpr Quantity& operator+=(Quantity o) {
    count_ += o.count_;
    return *this;
  }
  constexpr Quantity& operator-=(Quantity o) {
    count_ -= o.count_;
    return *this;
  }
  friend constexpr Quantity operator+(Quantity a, Quantity b) {
    return Quantity(a.count_ + b.count_);
  }
  friend constexpr Quantity operator-(Quantity a, Quantity b) {
    return Quantity(a.count_ - b.count_);
  }
  friend constexpr Quantity operator*(Quantity a, Rep k) { return Quantity(a.count_ * k); }
  friend constexpr Quantity operator*(Rep k, Quantity a) { return Quantity(k * a.count_); }
  friend constexpr auto operator<=>(Quantity, Quantity) = default;

 private:
  Rep count_{};
};

using Cycles = Quantity<struct CyclesTag, std::int64_t>;  ///< clock cycles of the domain at hand
using Bytes = Quantity<struct BytesTag, std::int64_t>;    ///< bytes
using Hertz = Quantity<struct HertzTag, std::int64_t>;    ///< whole hertz
using Seconds = Quantity<struct SecondsTag, double>;      ///< seconds
using Joules = Quantity<struct JoulesTag, double>;        ///< joules
using Watts = Quantity<struct WattsTag, double>;          ///< watts
using Volts = Quantity<struct VoltsTag, double>;          ///< volts

constexpr Joules operator*(Watts power, Seconds time) {
  return Joules(power.count() * time.count());
}
constexpr Watts operator/(Joules energy, Seconds time) {
  return Watts(energy.count() / time.count());
}

}  // namespace leviosim

namespace leviosim::base {

inline constexpr double kTwoPi = 6.283185307179586476925;
inline constexpr double kDegreesPerRadian = 57.295779513082320876798;

}  // namespace leviosim::base
