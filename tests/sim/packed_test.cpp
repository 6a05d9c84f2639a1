// Packed integers, half precision and 64-bit integers: the values, the same bits under both
// policies, and what each operation counts.
#include "sim/work/packed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "sim/work/half.h"
#include "sim/work/policy.h"
#include "sim/work/wide.h"

namespace leviosim::work {
namespace {

template <class P>
std::vector<int> packed_results() {
  std::vector<int> out;
  const I8x4<P> a{{127, -128, 5, -7}};
  const I8x4<P> b{{1, -1, -9, 100}};
  for (const I8x4<P>& v : {a + b, a - b, min(a, b), max(a, b), select<7, 0, 5, 2>(a, b)})
    for (const std::int8_t lane : v.lanes) out.push_back(lane);
  const I16x2<P> c{{-32768, 32767}};
  out.push_back(value(dot(c, c)));
  out.push_back(value(dot(a, b, typename P::I32(10))));
  out.push_back(value(c.lane(0)));
  out.push_back(value(dot(U16x2<P>{{65535, 65535}}, splat<U16x2<P>>(1))));
  return out;
}

TEST(Packed, LanesWrapAndSumsOfProductsAreWide) {
  const std::vector<int> expected = {-128, 127, -4, 93, 126, -127, 14, -107, 1, -128, -9, -7, 127,
                                     -1, 5, 100, 100, 127, -1, 5,
                                     // (-2^15)² + (2^15 - 1)², wrapped
                                     2147418113, 127 + 128 - 45 - 700 + 10, -32768, 131070};
  EXPECT_EQ(packed_results<Native>(), expected);
  EXPECT_EQ(packed_results<Counting>(), expected);
}

TEST(Packed, EachOperationCountsOnce) {
  take_tally();
  packed_results<Counting>();
  const Counts counts = take_tally();
  EXPECT_EQ(counts[Op::SimdAlu], 3U);
  EXPECT_EQ(counts[Op::SimdMinMax], 2U);
  EXPECT_EQ(counts[Op::SimdDot], 3U);
  EXPECT_EQ(counts[Op::IntAlu], 1U);
}

template <class P>
std::vector<int> unsigned_byte_results() {
  const U8x4<P> a{{0, 255, 17, 200}};
  const U8x4<P> b{{255, 0, 18, 201}};
  std::vector<int> out{value(add_differences(a, b, typename P::I32(1000)))};
  for (const std::uint8_t lane : average(a, b).lanes) out.push_back(lane);
  return out;
}

TEST(Packed, DifferencesOfBytesAreAbsoluteAndMeansKeepTheNinthBit) {
  const std::vector<int> expected = {1000 + 255 + 255 + 1 + 1, 127, 127, 17, 200};
  EXPECT_EQ(unsigned_byte_results<Native>(), expected);
  take_tally();
  EXPECT_EQ(unsigned_byte_results<Counting>(), expected);
  const Counts counts = take_tally();
  EXPECT_EQ(counts[Op::SimdSad], 1U);
  EXPECT_EQ(counts[Op::SimdAverage], 1U);
}

TEST(Half, EveryValueConvertsBackAndForth) {
  for (std::uint32_t bits = 0; bits < 0x10000U; ++bits) {
    const auto half = static_cast<std::uint16_t>(bits);
    if ((half & 0x7fffU) > 0x7c00U)
      EXPECT_TRUE(std::isnan(half_value(half)));
    else
      EXPECT_EQ(half_bits(half_value(half)), half);
  }
}

// Between each two neighbours: below the middle down, above it up, the middle to the even one.
TEST(Half, RoundsToNearestEven) {
  for (std::uint16_t low = 0; low < 0x7bffU; ++low) {
    const auto high = static_cast<std::uint16_t>(low + 1);
    const float middle = (half_value(low) + half_value(high)) / 2;
    EXPECT_EQ(half_bits(middle), low % 2 == 0 ? low : high) << low;
    EXPECT_EQ(half_bits(std::nextafter(middle, 0.0F)), low) << low;
    EXPECT_EQ(half_bits(-std::nextafter(middle, 1e9F)), high | 0x8000U) << low;
  }
  EXPECT_EQ(half_bits(65519.996F), 0x7bffU);
  EXPECT_EQ(half_bits(65520.0F), 0x7c00U);
}

template <class P>
std::vector<float> half_results() {
  const F16<P> a(1.5F);
  const F16<P> b(0.3333F);
  std::vector<float> out;
  for (const F16<P>& x : {a + b, a - b, a * b, a / b, mul_add(a, b, a)}) out.push_back(value(x));
  out.push_back(value(to_f32(to_f16<P>(typename P::F32(0.1F)))));
  return out;
}

TEST(Half, SameBitsUnderBothPoliciesAndItsCounts) {
  take_tally();
  const std::vector<float> counted = half_results<Counting>();
  const Counts counts = take_tally();
  EXPECT_EQ(counted, half_results<Native>());
  EXPECT_EQ(counts[Op::F16Op], 6U);
  EXPECT_EQ(counts[Op::F16Div], 1U);
  EXPECT_EQ(counted[0], 1.8330078125F);
  EXPECT_EQ(counted[3], 4.5F);  // 1.5 / 0.333251953125 = 4.50109…, and halves are 1/256 apart there
}

template <class P>
std::vector<std::int64_t> wide_results() {
  using I32 = typename P::I32;
  const I32 least = std::numeric_limits<std::int32_t>::min();
  I64<P> sum = mul_wide(least, I32(3));
  sum += mul_wide(least, least);
  sum = sum - I64<P>(5);
  return {value(sum), value(mul_high(least, I32(7))),
          value(mul_high(typename P::U32(0xffffffffU), typename P::U32(0xffffffffU)))};
}

TEST(Wide, ProductsAreWholeAndCountAsWhatTheyBecome) {
  take_tally();
  const std::vector<std::int64_t> counted = wide_results<Counting>();
  const Counts counts = take_tally();
  EXPECT_EQ(counted, wide_results<Native>());
  EXPECT_EQ(counted,
            (std::vector<std::int64_t>{-3 * (1LL << 31) + (1LL << 62) - 5, -4, 0xfffffffeLL}));
  EXPECT_EQ(counts[Op::Int64Mul], 1U);
  EXPECT_EQ(counts[Op::Int64Mac], 1U);
  EXPECT_EQ(counts[Op::Int64Add], 1U);
  EXPECT_EQ(counts[Op::IntMulHigh], 2U);
}

}  // namespace
}  // namespace leviosim::work
