// Trigonometry as C libraries compute it, against the host's in double precision.
#include "workload/levio/geometry/library_trig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/work/machine.h"
#include "tests/workload/math/math_fixture.h"

namespace leviosim::vio::levio {
namespace {

using P = work::Native;
using C = work::Counting;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Units in the last place of `exact`.
double ulps(float value, double exact) {
  const double unit = std::ldexp(1.0, std::max(std::ilogb(exact), -126) - 23);
  return std::abs(static_cast<double>(value) - exact) / unit;
}

TEST(LibraryTrig, SineAndCosineAreWithinTwoUnitsInTheLastPlace) {
  test::Random random(1);
  for (int i = 0; i < 200000; ++i) {
    const auto x = static_cast<float>(random.uniform(-1.0, 1.0) * (i % 2 == 0 ? 2.4 : 20.0));
    // Beside the zeros, an argument of 24 bits leaves fewer.
    if (std::abs(std::sin(2.0 * static_cast<double>(x))) < 1e-3) continue;
    ASSERT_LT(ulps(library_sin<P>(x), std::sin(static_cast<double>(x))), 2.0) << x;
    ASSERT_LT(ulps(library_cos<P>(x), std::cos(static_cast<double>(x))), 2.0) << x;
  }
}

TEST(LibraryTrig, TheArcTangentIsWithinTwoUnitsInTheLastPlace) {
  test::Random random(2);
  for (int i = 0; i < 200000; ++i) {
    const auto y = static_cast<float>(random.uniform(-1.0, 1.0) * (i % 3 == 0 ? 1.0 : 10.0));
    const auto x = static_cast<float>(random.uniform(-1.0, 1.0) * (i % 5 == 0 ? 1.0 : 10.0));
    const double exact = std::atan2(static_cast<double>(y), static_cast<double>(x));
    ASSERT_LT(ulps(library_atan2<P>(y, x), exact), 2.0) << y << " " << x;
  }
}

TEST(LibraryTrig, SpecialArguments) {
  EXPECT_EQ(library_sin<P>(0.0f), 0.0f);
  EXPECT_EQ(library_sin<P>(1e-10f), 1e-10f);
  EXPECT_EQ(library_cos<P>(0.0f), 1.0f);
  EXPECT_EQ(library_atan2<P>(0.0f, 1.0f), 0.0f);
  EXPECT_EQ(library_atan2<P>(0.0f, 2.0f), 0.0f);
  EXPECT_EQ(library_atan2<P>(0.0f, -2.0f), 3.14159274f);
  EXPECT_EQ(library_atan2<P>(3.0f, 0.0f), 1.57079637f);
  EXPECT_EQ(library_atan2<P>(-3.0f, 0.0f), -1.57079637f);
  EXPECT_EQ(library_atan2<P>(1e20f, 1e-10f), 1.57079637f);
  EXPECT_EQ(library_atan2<P>(1e-20f, -1e10f), 3.14159274f);
  for (const float x : {1.0f, 3.0f}) {
    EXPECT_TRUE(std::isnan(library_atan2<P>(kNone, x)));
    EXPECT_TRUE(std::isnan(library_atan2<P>(x, kNone)));
  }
  EXPECT_TRUE(std::isnan(library_sin<P>(kNone)));
  EXPECT_TRUE(std::isnan(library_cos<P>(kNone)));
}

// Counted scalars compute the same bits, and all three divide at most twice: y / x, and a part of
// the arc tangent.
TEST(LibraryTrig, CountedScalarsComputeTheSame) {
  test::Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const auto y = static_cast<float>(random.uniform(-3.0, 3.0));
    const auto x = static_cast<float>(random.uniform(-3.0, 3.0));
    work::take_tally();
    EXPECT_EQ(library_atan2<C>(C::F32(y), C::F32(x)).v, library_atan2<P>(y, x));
    EXPECT_EQ(library_sin<C>(C::F32(x)).v, library_sin<P>(x));
    EXPECT_EQ(library_cos<C>(C::F32(x)).v, library_cos<P>(x));
    const std::uint64_t divisions = work::take_tally()[work::Op::F32Div];
    EXPECT_GE(divisions, 1u);
    EXPECT_LE(divisions, 2u);
  }
}

}  // namespace
}  // namespace leviosim::vio::levio
