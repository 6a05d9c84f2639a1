#include "traces/synthesis/texture.h"

#include <gtest/gtest.h>

namespace leviosim::traces {
namespace {

Texture ramp() {
  std::vector<std::uint8_t> texels;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x) texels.push_back(static_cast<std::uint8_t>(10 * x + y));
  return Texture(16, 8, texels);
}

TEST(Texture, IsLinearBetweenTexelCentres) {
  const Texture texture = ramp();
  EXPECT_FLOAT_EQ(texture.sample(3.5f, 2.5f, 1), 32);
  EXPECT_FLOAT_EQ(texture.sample(4.0f, 2.5f, 1), 37);
  EXPECT_FLOAT_EQ(texture.sample(3.5f, 2.75f, 0.1f), 32.25f);
}

TEST(Texture, EdgesContinue) {
  const Texture texture = ramp();
  EXPECT_FLOAT_EQ(texture.sample(-5, -5, 1), 0);
  EXPECT_FLOAT_EQ(texture.sample(99, 99, 1), 157);
}

TEST(Texture, CoarserLevelsAverage) {
  std::vector<std::uint8_t> texels;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) texels.push_back((x + y) % 2 == 0 ? 200 : 100);
  const Texture checker(64, 64, texels);
  EXPECT_FLOAT_EQ(checker.sample(20.5f, 20.5f, 1), 200);
  EXPECT_FLOAT_EQ(checker.sample(20.5f, 20.5f, 2), 150);
  EXPECT_FLOAT_EQ(checker.sample(20.5f, 20.5f, 1.5f), 175) << "half-way between two levels";
  EXPECT_FLOAT_EQ(checker.sample(20.5f, 20.5f, 1e6f), 150) << "the coarsest level is the last";
}

TEST(Texture, LevelsKeepTheirPlace) {
  // On a linear ramp every level must give the same value at the same place.
  const Texture texture = ramp();
  for (const float footprint : {1.0f, 2.0f, 3.0f, 4.0f})
    EXPECT_NEAR(texture.sample(8, 4, footprint), 78.5f, 1.0f) << footprint;
}

}  // namespace
}  // namespace leviosim::traces
