// How outcomes are condensed: a figure over several runs that differ by their random draws or
// texture worlds, and over several sequences.
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace leviosim::tools {

/// Median, least and greatest. A run that failed counts as infinitely bad, so what it makes
/// infinite does not exist here.
struct Spread {
  std::size_t runs = 0;
  std::size_t failed = 0;
  std::optional<double> median;
  std::optional<double> low;
  std::optional<double> high;
};

/// @param values  of the runs; nothing for one that failed
Spread spread_of(const std::vector<std::optional<double>>& values);

/// Where the median of all that values could have been drawn from lies: between two of the values,
/// as far from the least as from the greatest.
struct MedianInterval {
  std::size_t values = 0;
  /// Of values that are drawn independently of each other: 1 - 2 P(fewer than k of n throws of a
  /// coin are heads), for the k-th value from either end of n. 0 for fewer than two values.
  double confidence = 0;
  std::optional<double> low;  ///< none where it is infinite, as with Spread
  std::optional<double> high;
};

/// The narrowest interval of at least this confidence; if no interval has it, from the least to the
/// greatest, with the confidence of that.
MedianInterval median_interval(const std::vector<std::optional<double>>& values,
                               double confidence = 0.95);

/// The values of a figure. @param of  figure of an outcome
template <class Outcomes, class Of>
std::vector<std::optional<double>> values_of(const Outcomes& outcomes, const Of& of) {
  std::vector<std::optional<double>> values;
  for (const auto& outcome : outcomes) values.push_back(std::invoke(of, outcome));
  return values;
}

/// None if one of them does not exist.
std::optional<double> mean_of(const std::vector<std::optional<double>>& values);

}  // namespace leviosim::tools
