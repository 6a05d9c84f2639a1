// A figure with its band: what it is expected to be, and how far each uncertainty source
// may move it.
//
// Rule of combination: what one source does to the parts of a sum adds up, since its numbers err
// together; the band of a figure is the root of the sum of squares over the sources, which are
// independent. So values add up exactly, and the band of a sum is at most the sum of the bands.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "sim/energy/uncertainty_sources.h"

namespace leviosim::sim {

/// @tparam Q  a Quantity of double
template <class Q>
struct Estimate {
  Q value{};
  std::array<Q, kUncertaintySourceCount> down{};  ///< by which each source may lower the value, ≥ 0
  std::array<Q, kUncertaintySourceCount> up{};    ///< and raise it

  /// Not below 0, where sources that multiply each other would lead.
  Q low() const { return std::max(value - root_sum_square(down), Q{}); }
  Q high() const { return value + root_sum_square(up); }

  Estimate& operator+=(const Estimate& o) {
    value += o.value;
    for (std::size_t i = 0; i < kUncertaintySourceCount; ++i) {
      down[i] += o.down[i];
      up[i] += o.up[i];
    }
    return *this;
  }
  /// @param k  ≥ 0
  friend Estimate operator*(Estimate a, double k) {
    a.value = a.value * k;
    for (std::size_t i = 0; i < kUncertaintySourceCount; ++i) {
      a.down[i] = a.down[i] * k;
      a.up[i] = a.up[i] * k;
    }
    return a;
  }

 private:
  static Q root_sum_square(const std::array<Q, kUncertaintySourceCount>& parts) {
    double sum = 0;
    for (const Q part : parts) sum += part.count() * part.count();
    return Q(std::sqrt(sum));
  }
};

/// Mean power over a time > 0.
inline Estimate<Watts> operator/(const Estimate<Joules>& energy, Seconds time) {
  Estimate<Watts> power;
  power.value = energy.value / time;
  for (std::size_t i = 0; i < kUncertaintySourceCount; ++i) {
    power.down[i] = energy.down[i] / time;
    power.up[i] = energy.up[i] / time;
  }
  return power;
}

}  // namespace leviosim::sim
