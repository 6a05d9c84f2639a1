#include "workload/geometry/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "sim/work/counts.h"

namespace leviosim::vio {
namespace {

using work::Counting;
using work::Native;

/// One step of the register as a matrix over GF(2): column i is the successor of the state 1 << i.
using BitMatrix = std::array<std::uint32_t, 32>;

BitMatrix step_matrix() {
  BitMatrix m;
  for (std::uint32_t i = 0; i < 32; ++i) m[i] = Lfsr32<Native>(1u << i).next();
  return m;
}
std::uint32_t product(const BitMatrix& m, std::uint32_t x) {
  std::uint32_t y = 0;
  for (std::size_t i = 0; i < 32; ++i)
    if (x >> i & 1u) y ^= m[i];
  return y;
}
BitMatrix power(BitMatrix base, std::uint32_t exponent) {
  BitMatrix result;
  for (std::size_t i = 0; i < 32; ++i) result[i] = 1u << i;
  for (; exponent != 0; exponent >>= 1) {
    if (exponent & 1u)
      for (std::uint32_t& column : result) column = product(base, column);
    BitMatrix square;
    for (std::size_t i = 0; i < 32; ++i) square[i] = product(base, base[i]);
    base = square;
  }
  return result;
}

TEST(Lfsr32, VisitsEveryNonZeroStateBeforeItRepeats) {
  // The period divides 2^32 - 1 = 3·5·17·257·65537, and no proper divisor of it.
  const BitMatrix step = step_matrix();
  const BitMatrix identity = power(step, 0);
  EXPECT_EQ(power(step, 0xffffffffu), identity);
  for (std::uint32_t prime : {3u, 5u, 17u, 257u, 65537u})
    EXPECT_NE(power(step, 0xffffffffu / prime), identity) << "period divides by " << prime;
}

TEST(Lfsr32, StepsAreLinearSoThatTheMatrixDescribesThem) {
  const BitMatrix step = step_matrix();
  Lfsr32<Native> random(0x12345678u);
  std::uint32_t state = 0x12345678u;
  for (int i = 0; i < 1000; ++i) {
    state = product(step, state);
    ASSERT_EQ(random.next(), state);
  }
}

TEST(Lfsr32, NumbersAreDistinctAndNeverZero) {
  for (std::uint32_t seed : {0u, 1u, 0xffffffffu}) {
    Lfsr32<Native> random(seed);
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

TEST(Lfsr32, BelowIsUniform) {
  for (int n : {7, 64, 101, 360, 704}) {
    Lfsr32<Native> random(1234u + static_cast<std::uint32_t>(n));
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
    draw_sample<Native>(random, indices(), indices().size(), k,
                        Native::Span<std::uint16_t>(sample.data(), k));
    return sample;
  }
  std::vector<std::uint16_t> table, sample;
  Lfsr32<Native> random;
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
  Lfsr32<Counting> random(5);
  number_consecutively<Counting>(indices);
  work::take_tally();
  for (int i = 0; i < kDraws; ++i) {
    draw_sample<Counting>(random, indices, kN, kSize,
                          Counting::Span<std::uint16_t>(sample.data(), kSize));
    ASSERT_EQ(native.draw(kSize), sample);
  }
  const work::Counts counts = work::take_tally();
  EXPECT_EQ(counts[work::Op::IntDiv], kDraws * kSize);
  EXPECT_EQ(counts[work::Op::LoadIndexed], kDraws * kSize);
  EXPECT_EQ(counts[work::Op::StoreIndexed], kDraws * kSize);
  EXPECT_EQ(counts[work::Op::StoreStream], 2 * kDraws * kSize);
  EXPECT_EQ(counts[work::Op::LoopIteration], kDraws * kSize);
}

}  // namespace
}  // namespace leviosim::vio
