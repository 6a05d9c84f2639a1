#include "traces/synthesis/frame_stamps.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace leviosim::traces {

StampList regular_stamps(std::int64_t begin_ns, std::int64_t end_ns, double rate_hz) {
  StampList stamps;
  for (std::int64_t t_ns = begin_ns; t_ns <= end_ns;
       t_ns = begin_ns + std::llround(static_cast<double>(stamps.size()) * 1e9 / rate_hz))
    stamps.push_back(t_ns);
  return stamps;
}

StampList stamps_within(const StampList& stamps, TimeSpan span) {
  const auto first = std::lower_bound(stamps.begin(), stamps.end(), span.begin_ns);
  return {first, std::upper_bound(first, stamps.end(), span.end_ns)};
}

StampList stamps_nearest_to_period(const StampList& grid, TimeSpan span, std::int64_t period_ns) {
  const StampList inside = stamps_within(grid, span);
  StampList chosen;
  if (inside.empty()) return chosen;
  for (std::int64_t t_ns = inside.front(); t_ns <= inside.back(); t_ns += period_ns) {
    const auto right = std::lower_bound(inside.begin(), inside.end(), t_ns);
    const bool left = right != inside.begin() && t_ns - *(right - 1) < *right - t_ns;
    const std::int64_t nearest = left ? *(right - 1) : *right;
    if (chosen.empty() || nearest > chosen.back()) chosen.push_back(nearest);
  }
  return chosen;
}

}  // namespace leviosim::traces
