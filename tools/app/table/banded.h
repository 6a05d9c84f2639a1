// Figures with their bands, and the combination of single effects into a band.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace leviosim::tools {

/// A figure with its band.
struct Banded {
  double value = 0;
  double low = 0;
  double high = 0;

  bool holds(double other) const { return low <= other && other <= high; }
  friend Banded operator*(double factor, const Banded& b) {
    return {factor * b.value, factor * b.low, factor * b.high};
  }
};

/// How much bands say: half of their widths, in per cent of the figure, the median. 0: there is
/// none.
inline double median_half_width(const std::vector<Banded>& bands) {
  if (bands.empty()) return 0;
  std::vector<double> widths;
  for (const Banded& b : bands) widths.push_back(50 * (b.high - b.low) / b.value);
  std::sort(widths.begin(), widths.end());
  const std::size_t half = widths.size() / 2;
  return widths.size() % 2 == 1 ? widths[half] : (widths[half - 1] + widths[half]) / 2;
}

/// The band of a figure that depends on numbers with independent errors: the root of the sum of the
/// squares of each one's effect, below and above.
class BandOf {
 public:
  explicit BandOf(double value) : value_(value) {}

  /// @param at_low, at_high  the figure with one number at both ends of its range
  void add(double at_low, double at_high) {
    const double below = std::max({0.0, value_ - at_low, value_ - at_high});
    const double above = std::max({0.0, at_low - value_, at_high - value_});
    below_ += below * below;
    above_ += above * above;
  }
  Banded band() const { return {value_, value_ - std::sqrt(below_), value_ + std::sqrt(above_)}; }

 private:
  double value_;
  double below_ = 0;  ///< squares
  double above_ = 0;
};

}  // namespace leviosim::tools
