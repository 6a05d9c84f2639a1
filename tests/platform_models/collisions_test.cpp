// How often cores meet at banks and units, as GAP9 has it, against cores that are stepped through
// cycle by cycle (FACTS.md#collisions).
#include <gtest/gtest.h>

#include <random>

#include "platform_models/loader/loader.h"
#include "sim/chip/contention.h"
#include "tests/support/stepped_sharing.h"

namespace leviosim::platform {
namespace {

TEST(Collisions, OfStreamsAreThoseOfLoopsSteppedThrough) {
  const sim::L1Config l1 = load_platform("gap9").cluster.l1;
  constexpr int kCores = 8;
  std::mt19937 random(1);
  double stalls = 0;
  double scattered = 0;
  for (int i = 0; i < 1500; ++i) {
    const auto loops = leviosim::testing::StreamLoops::draw(random, kCores);
    const auto lost = leviosim::testing::step_streams(loops, kCores, l1.banks);
    stalls += lost.stalls;
    scattered += (kCores - 1) * lost.accesses * lost.accesses / (2 * l1.banks);
  }
  EXPECT_NEAR(stalls / scattered, l1.stream_conflicts, 0.1);
}

TEST(Collisions, OfTwoCoresInOneLoopAreThoseOfPairsSteppedThrough) {
  const double collisions = load_platform("gap9").cluster.fpu.collisions;
  std::mt19937 random(1);
  double lost = 0;
  double by_chance = 0;
  for (const std::size_t size : {16, 40, 100})
    for (int i = 0; i < 60; ++i) {
      const std::size_t uses = 1 + random() % (size / 2);
      const auto loop = leviosim::testing::draw_loop(random, size, uses);
      const double density = static_cast<double>(uses) / static_cast<double>(size);
      for (std::size_t phase = 0; phase < size; phase += 1 + size / 16) {
        const auto pair = leviosim::testing::step_pair(loop, loop, phase, 2000);
        lost += (pair[0] + pair[1]) / 2;
        by_chance += sim::met_by_chance(density, density);
      }
    }
  EXPECT_NEAR(lost / by_chance, collisions, 0.1);
}

/// Nineteen operations of a unit, some of them in a row: how long two cores take depends on when
/// they begin. The mean of the phases is what the model has; its band holds them all.
TEST(Collisions, ThePhaseDecidesWhatTheMeanLeavesOpen) {
  std::mt19937 random(5);
  const auto loop = leviosim::testing::draw_loop(random, 40, 19);
  const double chance = sim::met_by_chance(19.0 / 40, 19.0 / 40);
  double mean = 0;
  double least = 1;
  double most = 0;
  for (std::size_t phase = 0; phase < 40; ++phase) {
    const auto pair = leviosim::testing::step_pair(loop, loop, phase, 4000);
    const double lost = (pair[0] + pair[1]) / 2;
    mean += lost / 40;
    least = std::min(least, lost);
    most = std::max(most, lost);
  }
  EXPECT_NEAR(mean, chance, 0.25 * chance);
  EXPECT_LT(least, 0.8 * chance);
  EXPECT_GT(most, 1.2 * chance);
}

}  // namespace
}  // namespace leviosim::platform
