#include "tools/app/study/spread.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace leviosim::tools {

Spread spread_of(const std::vector<std::optional<double>>& values) {
  Spread spread;
  std::vector<double> sorted;
  for (const std::optional<double>& value : values) {
    ++spread.runs;
    if (!value) ++spread.failed;
    sorted.push_back(value.value_or(std::numeric_limits<double>::infinity()));
  }
  if (sorted.empty()) return spread;
  std::sort(sorted.begin(), sorted.end());
  const auto finite = [](double value) {
    return std::isfinite(value) ? std::optional(value) : std::nullopt;
  };
  spread.median = finite(0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]));
  spread.low = finite(sorted.front());
  spread.high = finite(sorted.back());
  return spread;
}

std::optional<double> mean_of(const std::vector<std::optional<double>>& values) {
  double sum = 0;
  for (const std::optional<double>& value : values) {
    if (!value) return std::nullopt;
    sum += *value;
  }
  return sum / static_cast<double>(values.size());
}

}  // namespace leviosim::tools
