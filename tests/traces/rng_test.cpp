#include "traces/datasets/rng.h"

#include <gtest/gtest.h>

#include <set>

namespace leviosim::traces {
namespace {

TEST(TracesRng, MatchesThePublishedSequence) {
  // First outputs of SplitMix64 for seed 1234567, as in the reference implementations.
  Rng rng(1234567);
  EXPECT_EQ(rng.next(), 6457827717110365317u);
  EXPECT_EQ(rng.next(), 3203168211198807973u);
  EXPECT_EQ(rng.next(), 9817491932198370423u);
}

TEST(TracesRng, UniformAndNormalHaveTheirMoments) {
  Rng rng(9);
  constexpr int kDraws = 200'000;
  double uniform = 0, normal = 0, normal2 = 0, normal4 = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double u = rng.uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    uniform += u / kDraws;
    const double n = rng.normal();
    normal += n / kDraws;
    normal2 += n * n / kDraws;
    normal4 += n * n * n * n / kDraws;
  }
  EXPECT_NEAR(uniform, 0.5, 0.003);
  EXPECT_NEAR(normal, 0, 0.01);
  EXPECT_NEAR(normal2, 1, 0.015);
  EXPECT_NEAR(normal4, 3, 0.12);
}

TEST(TracesRng, RangesHold) {
  Rng rng(10);
  std::set<int> seen;
  for (int i = 0; i < 1000; ++i) {
    seen.insert(rng.below(5));
    const double x = rng.log_uniform(0.1, 10);
    EXPECT_GE(x, 0.1);
    EXPECT_LT(x, 10);
  }
  EXPECT_EQ(seen, (std::set<int>{0, 1, 2, 3, 4}));
}

TEST(TracesRng, DerivedSeedsDiffer) {
  std::set<std::uint64_t> seeds;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    for (std::uint64_t part = 0; part < 100; ++part) seeds.insert(derive_seed(seed, part));
  EXPECT_EQ(seeds.size(), 10'000u);
}

}  // namespace
}  // namespace leviosim::traces
