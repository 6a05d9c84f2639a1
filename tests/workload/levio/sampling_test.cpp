#include "workload/levio/geometry/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "sim/work/counts.h"

namespace leviosim::vio::levio {
namespace {

using work::Counting;
using work::Native;

TEST(ShiftRegister, IsThatOfTheRelease) {
  ShiftRegister<Native> random(0x80000056u);  // ones at three of the taps and above
  std::uint32_t state = 0x80000056u;
  for (int i = 0; i < 1000; ++i) {
    std::uint32_t bit = 0;
    for (const int tap : {31, 6, 4, 2, 1, 0}) bit ^= state >> tap & 1u;
    state = state >> 1 | bit << 31;
    ASSERT_EQ(random.next(), state);
  }
}

TEST(ShiftRegister, NumbersAreDistinctAndNeverZero) {
  for (std::uint32_t seed : {0u, 1u, 0x2545f491u, 0x9e3779b2u}) {
    ShiftRegister<Native> random(seed);
    std::unordered_set<std::uint32_t> seen;
    for (int i = 0; i < 100000; ++i) {
      const std::uint32_t x = random.next();
      ASSERT_NE(x, 0u);
      ASSERT_TRUE(seen.insert(x).second) << "repeats after " << i << " steps";
    }
  }
}

/// Pearson's statistic, as its distance from the expectation in standard deviations.
double chi_square_sigmas(const std::vector<int>& histogram) {
  const double bins = static_cast<double>(histogram.size());
  double total = 0;
  for (int count : histogram) total += count;
  double chi = 0;
  for (int count : histogram) chi += (count - total / bins) * (count - total / bins) * bins / total;
  return (chi - (bins - 1)) / std::sqrt(2 * (bins - 1));
}

TEST(ShiftRegister, BelowIsUniform) {
  for (int n : {7, 64, 101, 360, 704}) {
    ShiftRegister<Native> random(1234u + static_cast<std::uint32_t>(n));
    std::vector<int> histogram(static_cast<std::size_t>(n));
    for (int i = 0; i < 500 * n; ++i) {
      const int x = random.below(n);
      ASSERT_GE(x, 0);
      ASSERT_LT(x, n);
      ++histogram[static_cast<std::size_t>(x)];
    }
    EXPECT_LT(std::abs(chi_square_sigmas(histogram)), 5) << "n = " << n;
  }
}

struct Sampler {
  explicit Sampler(int n, std::uint32_t seed)
      : table(static_cast<std::size_t>(n)), sample(8), random(seed) {
    number_consecutively<Native>(indices());
  }
  Native::Span<std::uint16_t> indices() { return {table.data(), static_cast<int>(table.size())}; }
  const std::vector<std::uint16_t>& draw(int k) {
    draw_sample<Native>(random, indices(), k, Native::Span<std::uint16_t>(sample.data(), k));
    return sample;
  }
  std::vector<std::uint16_t> table, sample;
  ShiftRegister<Native> random;
};

TEST(DrawSample, IndicesAreDistinctAndTheTableStaysAPermutation) {
  for (int n : {8, 9, 60, 704}) {
    Sampler sampler(n, 99);
    for (int i = 0; i < 500; ++i) {
      std::vector<std::uint16_t> sample = sampler.draw(8);
      std::sort(sample.begin(), sample.end());
      ASSERT_EQ(std::adjacent_find(sample.begin(), sample.end()), sample.end());
      ASSERT_LT(sample.back(), n);
    }
    std::vector<std::uint16_t> table = sampler.table;
    std::sort(table.begin(), table.end());
    for (int i = 0; i < n; ++i) EXPECT_EQ(table[static_cast<std::size_t>(i)], i);
  }
}

TEST(DrawSample, ChoosesEveryIndexAndEveryPairEquallyOften) {
  constexpr int kN = 40;
  Sampler sampler(kN, 7);
  std::vector<int> single(kN), pairs(kN * kN), distinct_pairs;
  for (int i = 0; i < 40000; ++i) {
    const auto& sample = sampler.draw(8);
    for (int a = 0; a < 8; ++a) {
      ++single[sample[static_cast<std::size_t>(a)]];
      for (int b = 0; b < 8; ++b)
        ++pairs[static_cast<std::size_t>(sample[static_cast<std::size_t>(a)] * kN +
                                         sample[static_cast<std::size_t>(b)])];
    }
  }
  for (int a = 0; a < kN; ++a)
    for (int b = 0; b < a; ++b)
      distinct_pairs.push_back(pairs[static_cast<std::size_t>(a * kN + b)]);
  EXPECT_LT(std::abs(chi_square_sigmas(single)), 5);
  EXPECT_LT(std::abs(chi_square_sigmas(distinct_pairs)), 5);
}

TEST(DrawSample, CountingDrawsTheSameAndCountsTheWork) {
  constexpr int kN = 50, kDraws = 20, kSize = 8;
  Sampler native(kN, 5);
  std::vector<std::uint16_t> table(kN), sample(kSize);
  const Counting::Span<std::uint16_t> indices(table.data(), kN);
  ShiftRegister<Counting> random(5);
  number_consecutively<Counting>(indices);
  work::take_tally();
  for (int i = 0; i < kDraws; ++i) {
    draw_sample<Counting>(random, indices, kSize,
                          Counting::Span<std::uint16_t>(sample.data(), kSize));
    ASSERT_EQ(native.draw(kSize), sample);
  }
  const work::Counts counts = work::take_tally();
  EXPECT_EQ(counts[work::Op::IntDiv], 2 * kDraws * kSize);
  EXPECT_EQ(counts[work::Op::LoadIndexed], kDraws * kSize);
  EXPECT_EQ(counts[work::Op::StoreIndexed], kDraws * kSize);
  EXPECT_EQ(counts[work::Op::StoreStream], 2 * kDraws * kSize);
  EXPECT_EQ(counts[work::Op::LoopIteration], kDraws * kSize);
}

/// In a batch on so many cores, where so many have room.
int hypotheses_of(int cores, int fitting) {
  const Bytes each(100), padding(4), best(80);
  const work::Machine machine({.cores = cores, .capacity = (each + padding) * fitting + best});
  return Batches(640, 0, machine, each).largest();
}

// A team of fewer cores waits no more often than the eight of the release, and no core is idle.
TEST(Batches, AreEightHypothesesOrTheNextMultipleOfTheCores) {
  for (const auto& [cores, hypotheses] :
       {std::pair{1, 1}, {2, 8}, {3, 9}, {4, 8}, {6, 12}, {7, 14}, {8, 8}, {9, 9}, {16, 16}})
    EXPECT_EQ(hypotheses_of(cores, 100), hypotheses) << cores;
}

TEST(Batches, OfALittleMemoryAreOneForEachCoreOrAsManyAsHaveRoom) {
  EXPECT_EQ(hypotheses_of(4, 8), 8);
  EXPECT_EQ(hypotheses_of(4, 7), 4);
  EXPECT_EQ(hypotheses_of(4, 3), 3);
  EXPECT_EQ(hypotheses_of(16, 12), 12);
  EXPECT_EQ(hypotheses_of(8, 0), 1);
}

}  // namespace
}  // namespace leviosim::vio::levio
