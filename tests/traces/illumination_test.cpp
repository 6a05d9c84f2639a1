#include "traces/synthesis/illumination.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace leviosim::traces {
namespace {

TEST(Illumination, ChangesSlowlyWithinItsBounds) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Illumination light(seed);
    constexpr double kStep = 0.01;
    for (double t = -30; t < 120; t += kStep) {
      const double gain = light.gain(t);
      ASSERT_GE(gain, (1 - Illumination::kDrift) * Illumination::kDarkGain - 1e-12);
      ASSERT_LE(gain, 1 + Illumination::kDrift);
      ASSERT_LT(std::abs(light.gain(t + kStep) - gain), 0.03) << seed << " " << t;
    }
  }
}

TEST(Illumination, EveryPeriodHasOneDarkStretch) {
  const Illumination light(7);
  constexpr double kStep = 0.01;
  for (int period = 0; period < 6; ++period) {
    double dark_s = 0;
    const double begin = period * Illumination::kDarkEveryS;
    for (double t = begin; t < begin + Illumination::kDarkEveryS; t += kStep)
      if (light.gain(t) < 0.5) dark_s += kStep;
    EXPECT_NEAR(dark_s, Illumination::kDarkS - Illumination::kRampS, 0.5) << period;
  }
}

TEST(Illumination, FollowsFromTheSeed) {
  EXPECT_EQ(Illumination(1).gain(3), Illumination(1).gain(3));
  EXPECT_NE(Illumination(1).gain(3), Illumination(2).gain(3));
}

}  // namespace
}  // namespace leviosim::traces
