// IEEE half precision: what the floating-point units of some clusters do faster than single. The
// bits are the same under both policies and on every host: operands are widened to float, one
// operation is done there, and the result is rounded to nearest, even. That is the correctly
// rounded result for sums, products and quotients (float has 2·11+2 bits).
//
// A multiply-add rounds twice, as a product and a sum; like the other counted scalars only its
// *count* is that of the fused form. Left out: comparisons, square roots, bfloat16, packed pairs
// (one operation counts the same whether it works on one value or on two).
#pragma once

#include <bit>
#include <cstdint>

#include "sim/work/functions.h"

namespace leviosim::work {

/// The half nearest to a float, as bits.
constexpr std::uint16_t half_bits(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const std::uint32_t sign = (bits >> 16) & 0x8000U;
  const std::uint32_t magnitude = bits & 0x7fffffffU;
  std::uint32_t half = 0;
  if (magnitude > 0x7f800000U) {
    half = 0x7e00U;  // not a number
  } else if (magnitude >= 0x477ff000U) {
    half = 0x7c00U;  // 65520 and above round to infinity
  } else if (magnitude < 0x38800000U) {
    // Below 2^-14 halves are multiples of 2^-24, and so are floats near 0.5: the sum rounds.
    const float shifted = std::bit_cast<float>(magnitude) + 0.5F;
    half = std::bit_cast<std::uint32_t>(shifted) - std::bit_cast<std::uint32_t>(0.5F);
  } else {
    half = ((magnitude + 0xfffU + ((magnitude >> 13) & 1U)) >> 13) - (112U << 10);
  }
  return static_cast<std::uint16_t>(sign | half);
}

constexpr float half_value(std::uint16_t half) {
  const std::uint32_t sign = (half & 0x8000U) << 16;
  const std::uint32_t magnitude = half & 0x7fffU;
  std::uint32_t bits = 0;
  if (magnitude >= 0x7c00U)
    bits = 0x7f800000U | (magnitude & 0x3ffU) << 13;
  else if (magnitude < 0x400U)
    bits = std::bit_cast<std::uint32_t>(static_cast<float>(magnitude) * 0x1p-24F);
  else
    bits = (magnitude << 13) + (112U << 23);
  return std::bit_cast<float>(sign | bits);
}

template <bool Counted>
struct Half {
  using Single = std::conditional_t<Counted, F32, float>;

  std::uint16_t bits;

  Half() = default;
  /// A constant; conversions of computed values are to_f16() and to_f32().
  explicit constexpr Half(float x) : bits(half_bits(x)) {}

  friend Half operator+(Half a, Half b) { return done(Op::F16Op, a.v() + b.v()); }
  friend Half operator-(Half a, Half b) { return done(Op::F16Op, a.v() - b.v()); }
  friend Half operator*(Half a, Half b) { return done(Op::F16Op, a.v() * b.v()); }
  friend Half operator/(Half a, Half b) { return done(Op::F16Div, a.v() / b.v()); }
  /// a·b + c.
  friend Half mul_add(Half a, Half b, Half c) {
    return done(Op::F16Op, Half(a.v() * b.v()).v() + c.v());
  }
  friend Single to_f32(Half x) {
    note(Op::F16Op);
    return Single(x.v());
  }
  static Half from(Single x) { return done(Op::F16Op, work::value(x)); }
  friend float value(Half x) { return x.v(); }

 private:
  constexpr float v() const { return half_value(bits); }
  static void note(Op op) {
    if constexpr (Counted) count(op);
  }
  static Half done(Op op, float result) {
    note(op);
    return Half(result);
  }
};

template <class P>
using F16 = Half<P::kCounting>;

template <class P>
F16<P> to_f16(typename P::F32 x) {
  return F16<P>::from(x);
}

}  // namespace leviosim::work
