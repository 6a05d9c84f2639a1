#include "traces/frame_stamps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace leviosim::traces {

Stamps regular_stamps(std::int64_t begin_ns, std::int64_t end_ns, double rate_hz) {
  Stamps stamps;
  for (std::int64_t t_ns = begin_ns; t_ns <= end_ns;
       t_ns = begin_ns + std::llround(static_cast<double>(stamps.size()) * 1e9 / rate_hz))
    stamps.push_back(t_ns);
  return stamps;
}

Stamps stamps_within(const Stamps& stamps, TimeSpan span) {
  const auto first = std::lower_bound(stamps.begin(), stamps.end(), span.begin_ns);
  return {first, std::upper_bound(first, stamps.end(), span.end_ns)};
}

Stamps stamps_nearest_to_period(const Stamps& grid, TimeSpan span, std::int64_t period_ns) {
  const Stamps inside = stamps_within(grid, span);
  Stamps chosen;
  if (inside.empty()) return chosen;
  for (std::int64_t t_ns = inside.front(); t_ns <= inside.back(); t_ns += period_ns) {
    const auto right = std::lower_bound(inside.begin(), inside.end(), t_ns);
    const bool left = right != inside.begin() && t_ns - *(right - 1) < *right - t_ns;
    const std::int64_t nearest = left ? *(right - 1) : *right;
    if (chosen.empty() || nearest > chosen.back()) chosen.push_back(nearest);
  }
  return chosen;
}

Stamps selected(const Stamps& stamps, const FrameRange& range, const std::string& what) {
  check_frame_range(range, stamps.size(), what);
  return {stamps.begin() + static_cast<std::ptrdiff_t>(range.begin),
          stamps.begin() + static_cast<std::ptrdiff_t>(range.end)};
}

}  // namespace leviosim::traces
