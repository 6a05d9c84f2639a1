#include "tools/app/study/spread.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace leviosim::tools {
namespace {

std::vector<double> sorted_values(const std::vector<std::optional<double>>& values) {
  std::vector<double> sorted;
  for (const std::optional<double>& value : values)
    sorted.push_back(value.value_or(std::numeric_limits<double>::infinity()));
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

std::optional<double> finite(double value) {
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

Spread spread_of(const std::vector<std::optional<double>>& values) {
  Spread spread;
  for (const std::optional<double>& value : values) {
    ++spread.runs;
    if (!value) ++spread.failed;
  }
  const std::vector<double> sorted = sorted_values(values);
  if (sorted.empty()) return spread;
  spread.median = finite(0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]));
  spread.low = finite(sorted.front());
  spread.high = finite(sorted.back());
  return spread;
}

MedianInterval median_interval(const std::vector<std::optional<double>>& values,
                               double confidence) {
  const std::vector<double> sorted = sorted_values(values);
  const std::size_t count = sorted.size();
  MedianInterval interval;
  interval.values = count;
  if (count < 2) return interval;
  // The logarithm of the probability of k heads in `count` throws, which itself may be too small.
  double log_of_k = -static_cast<double>(count) * std::log(2.0);
  double fewer = std::exp(log_of_k);  // k heads or fewer
  std::size_t from_end = 0;
  interval.confidence = 1 - 2 * fewer;
  for (std::size_t k = 1; 2 * k + 1 < count; ++k) {
    log_of_k += std::log(static_cast<double>(count - k + 1) / static_cast<double>(k));
    fewer += std::exp(log_of_k);
    if (1 - 2 * fewer < confidence) break;
    interval.confidence = 1 - 2 * fewer;
    from_end = k;
  }
  interval.low = finite(sorted[from_end]);
  interval.high = finite(sorted[count - 1 - from_end]);
  return interval;
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
