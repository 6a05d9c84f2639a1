#include "tools/app/report/plot/colour_scale.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace leviosim::tools::plot {
namespace {

using Rgb = std::array<double, 3>;
constexpr std::array<Rgb, 4> kStops{{{32, 62, 140}, {29, 145, 140}, {232, 156, 40}, {190, 32, 46}}};

}  // namespace

int colour_index(double value, double max) {
  if (!(max > 0)) return 0;
  return std::min(static_cast<int>(std::clamp(value / max, 0.0, 1.0) * kColours), kColours - 1);
}

std::string colour(int index) {
  const double place = static_cast<double>(index) / (kColours - 1) * (kStops.size() - 1);
  const std::size_t stop = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
  const double s = place - static_cast<double>(stop);
  const auto mix = [&](std::size_t i) {
    return static_cast<int>(std::lround((1 - s) * kStops[stop][i] + s * kStops[stop + 1][i]));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2));
}

}  // namespace leviosim::tools::plot
