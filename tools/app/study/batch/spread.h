// A figure over several runs that differ by their random draws or texture worlds.
#pragma once

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

}  // namespace leviosim::tools
