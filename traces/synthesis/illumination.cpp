#include "traces/synthesis/illumination.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sim/base/units.h"
#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

constexpr double kSlowPeriodS = 37;

constexpr double kFastPeriodS = 11;

}  // namespace

Illumination::Illumination(std::uint64_t seed) : seed_(seed) {
  Rng rng(seed);
  for (double& phase : phases_) phase = rng.uniform(0, base::kTwoPi);
}

double Illumination::darkness(double t_s) const {
  const double period = std::floor(t_s / kDarkEveryS);
  Rng rng(derive_seed(seed_, static_cast<std::uint64_t>(static_cast<std::int64_t>(period))));
  const double begin = rng.uniform(0, kDarkEveryS - kDarkS);
  const double since = t_s - period * kDarkEveryS - begin;
  const double depth = std::clamp(std::min(since, kDarkS - since) / kRampS, 0.0, 1.0);
  return depth * depth * (3 - 2 * depth);
}

double Illumination::gain(double t_s) const {
  const double drift = 0.6 * std::sin(base::kTwoPi * t_s / kSlowPeriodS + phases_[0]) +
                       0.4 * std::sin(base::kTwoPi * t_s / kFastPeriodS + phases_[1]);
  return (1 + kDrift * drift) * (1 - (1 - kDarkGain) * darkness(t_s));
}

}  // namespace leviosim::traces
