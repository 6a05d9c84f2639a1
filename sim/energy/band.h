// A figure with its band: what it is expected to be, and what it would be if every uncertain number
// behind it stood at the low or at the high end of its range.
//
// Rule of combination: all numbers err in the same direction (fully correlated). Bands of sums are
// sums of bands, so tables add up in all three columns. The rule is deliberately wide: the main
// doubt about published energies, which voltage they were taken at, is common to most of them.
#pragma once

namespace leviosim::sim {

template <class T>
struct Banded {
  T value{};
  T low{};
  T high{};

  constexpr Banded& operator+=(const Banded& o) {
    value += o.value;
    low += o.low;
    high += o.high;
    return *this;
  }
  friend constexpr Banded operator+(Banded a, const Banded& b) { return a += b; }
  /// @param k  ≥ 0
  friend constexpr Banded operator*(const Banded& b, double k) {
    return {b.value * k, b.low * k, b.high * k};
  }
};

/// Applies `f` to a figure and to both ends of its band.
template <class T, class F>
constexpr auto each(const Banded<T>& b, F&& f) -> Banded<decltype(f(b.value))> {
  return {f(b.value), f(b.low), f(b.high)};
}

}  // namespace leviosim::sim
