// Sine, cosine and arc tangent as C libraries for small cores compute them in single precision: the
// released program calls its library (PARAMETERS.md#linear-algebra). They tell ranges apart by the
// bits of their arguments, treat every special value, and evaluate longer polynomials than
// workload/math/trig.h, which costs some three times as much.
//
// Method: reduction to |r| ≤ π/4 in two parts (sine, cosine) or to |t| ≤ 7/16 about one of four
// points (arc tangent), then the Taylor polynomial to the last coefficient that matters in single
// precision. Sizes of the code: a public C library's (tools/rv32).
//
// Left out: |x| > 200, for which libraries keep a table of the digits of 2/π; infinities of the arc
// tangent.
#pragma once

#include "sim/work/policy.h"
#include "workload/math/target_compiler.h"

namespace leviosim::vio::levio {

namespace library {

inline constexpr std::int32_t kNoSign = 0x7fffffff;
inline constexpr std::int32_t kInfinity = 0x7f800000;  ///< above are those that are no numbers
inline constexpr std::int32_t kOne = 0x3f800000;
inline constexpr std::int32_t kQuarterPi = 0x3f490fd8;
inline constexpr std::int32_t kThreeQuarterPi = 0x4016cbe4;
inline constexpr float kHalfPiHead = 1.57078552f, kHalfPiTail = 1.0804334e-05f;
inline constexpr float kPi = 3.14159274f, kPiTail = -8.74227801e-08f;
inline constexpr float kHalfPi = 1.57079637f;

/// x = quadrant · π/2 + head + tail with |head| ≤ π/4
template <class P>
struct Reduced {
  typename P::F32 head, tail;
  typename P::I32 quadrant;
};

/// @param bits  of |x|
template <class P>
Reduced<P> reduce(typename P::F32 x, typename P::I32 bits) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  constexpr float kTwoOverPi = 0.636619747f;
  const bool is_positive = static_cast<bool>(x > 0.0f);
  if (bits < kThreeQuarterPi) {
    const F rest = is_positive ? F(x - kHalfPiHead) : F(x + kHalfPiHead);
    const F head = is_positive ? F(rest - kHalfPiTail) : F(rest + kHalfPiTail);
    const F tail = is_positive ? F((rest - head) - kHalfPiTail) : F((rest - head) + kHalfPiTail);
    return {head, tail, I32(is_positive ? 1 : -1)};
  }
  const F size = work::abs(x);
  const I32 quadrant = work::to_i32(F(size * kTwoOverPi + F(0.5f)));
  const F turns = work::to_f32(quadrant);
  const F rest = size - turns * kHalfPiHead;
  const F correction = turns * kHalfPiTail;
  const F head = rest - correction;
  const F tail = (rest - head) - correction;
  if (is_positive) return {head, tail, quadrant};
  return {-head, -tail, -quadrant};
}

/// sin(r) for r = head + tail
template <class P>
typename P::F32 sin_reduced(typename P::F32 r, typename P::F32 tail, bool has_tail) {
  using F = typename P::F32;
  constexpr std::int32_t kTiny = 0x32000000;
  if ((work::bits_of(r) & kNoSign) < kTiny) return r;
  const F z = r * r;
  const F cubed = z * r;
  F s = z * F(1.60590438e-10f) + F(-2.50521084e-08f);
  s = z * s + F(2.75573192e-06f);
  s = z * s + F(-1.98412698e-04f);
  s = z * s + F(8.33333333e-03f);
  constexpr float kCubic = -1.66666667e-01f;
  if (!has_tail) return r + cubed * (F(kCubic) + z * s);
  return r - ((z * (0.5f * tail - cubed * s) - tail) - cubed * kCubic);
}

/// cos(r) for r = head + tail
template <class P>
typename P::F32 cos_reduced(typename P::F32 r, typename P::F32 tail) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  constexpr std::int32_t kTiny = 0x32000000, kSmall = 0x3e99999a, kLarge = 0x3f480000;
  const I32 bits = work::bits_of(r) & kNoSign;
  if (bits < kTiny) return 1.0f;
  const F z = r * r;
  F c = z * F(-1.14707456e-11f) + F(2.08767570e-09f);
  c = z * c + F(-2.75573192e-07f);
  c = z * c + F(2.48015873e-05f);
  c = z * c + F(-1.38888889e-03f);
  c = z * (z * c + F(4.16666667e-02f));
  const F rest = z * c - r * tail;
  if (bits < kSmall) return 1.0f - (0.5f * z - rest);
  // A share of z / 2 that is exact leaves the rounding to what remains.
  const F share = bits > kLarge ? F(0.28125f) : work::float_of_bits(bits - 0x01000000);
  const F half = 0.5f * z - share;
  const F base = 1.0f - share;
  return base - (half - rest);
}

/// atan(x)
template <class P>
typename P::F32 atan_of(typename P::F32 x) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  constexpr std::int32_t kTiny = 0x31000000, kHuge = 0x50800000;
  constexpr std::int32_t k7Over16 = 0x3ee00000, k11Over16 = 0x3f300000, k19Over16 = 0x3f980000,
                         k39Over16 = 0x401c0000;
  const I32 bits = work::bits_of(x) & kNoSign;
  if (bits >= kHuge) {
    if (bits > kInfinity) return x + x;
    return x > 0.0f ? F(kHalfPi) : F(-kHalfPi);
  }
  const bool is_small = static_cast<bool>(bits < k7Over16);
  F t = x, point = 0.0f, point_tail = 0.0f;
  if (is_small) {
    if (bits < kTiny) return x;
  } else {
    const F size = work::abs(x);
    if (bits < k19Over16) {
      if (bits < k11Over16) {
        t = (2.0f * size - 1.0f) / (2.0f + size);
        point = 0.463647604f;
        point_tail = 5.01215863e-09f;
      } else {
        t = (size - 1.0f) / (size + 1.0f);
        point = 0.785398185f;
        point_tail = -2.1855695e-08f;
      }
    } else if (bits < k39Over16) {
      t = (size - 1.5f) / (1.0f + 1.5f * size);
      point = 0.982793748f;
      point_tail = -2.51314246e-08f;
    } else {
      t = -1.0f / size;
      point = kHalfPi;
      point_tail = -4.37113901e-08f;
    }
  }
  const F z = t * t;
  const F w = z * z;
  F even = w * F(1.0f / 23) + F(1.0f / 19);
  even = w * even + F(1.0f / 15);
  even = w * even + F(1.0f / 11);
  even = w * even + F(1.0f / 7);
  even = z * (w * even + F(1.0f / 3));
  F odd = w * F(-1.0f / 21) + F(-1.0f / 17);
  odd = w * odd + F(-1.0f / 13);
  odd = w * odd + F(-1.0f / 9);
  odd = w * (w * odd + F(-1.0f / 5));
  if (is_small) return t - t * (even + odd);
  const F angle = point - ((t * (even + odd) - point_tail) - t);
  return x < 0.0f ? F(-angle) : angle;
}

}  // namespace library

/// Sine of x radians; x if it is no number.
template <class P>
LEVIOSIM_TARGET_CALL typename P::F32 library_sin(typename P::F32 x) {
  using F = typename P::F32;
  const typename P::Function function("library_sin");
  const typename P::I32 bits = work::bits_of(x) & library::kNoSign;
  if (bits <= library::kQuarterPi) return library::sin_reduced<P>(x, 0.0f, false);
  if (bits >= library::kInfinity) return x - x;
  const library::Reduced<P> a = library::reduce<P>(x, bits);
  const typename P::I32 quadrant = a.quadrant & 3;
  if (quadrant == 0) return library::sin_reduced<P>(a.head, a.tail, true);
  if (quadrant == 1) return library::cos_reduced<P>(a.head, a.tail);
  if (quadrant == 2) return F(-library::sin_reduced<P>(a.head, a.tail, true));
  return F(-library::cos_reduced<P>(a.head, a.tail));
}

/// Cosine of x radians; x if it is no number.
template <class P>
LEVIOSIM_TARGET_CALL typename P::F32 library_cos(typename P::F32 x) {
  using F = typename P::F32;
  const typename P::Function function("library_cos");
  const typename P::I32 bits = work::bits_of(x) & library::kNoSign;
  if (bits <= library::kQuarterPi) return library::cos_reduced<P>(x, 0.0f);
  if (bits >= library::kInfinity) return x - x;
  const library::Reduced<P> a = library::reduce<P>(x, bits);
  const typename P::I32 quadrant = a.quadrant & 3;
  if (quadrant == 0) return library::cos_reduced<P>(a.head, a.tail);
  if (quadrant == 1) return F(-library::sin_reduced<P>(a.head, a.tail, true));
  if (quadrant == 2) return F(-library::cos_reduced<P>(a.head, a.tail));
  return library::sin_reduced<P>(a.head, a.tail, true);
}

/// Angle of (x, y) in radians, in [-π, π]; not a number if one of them is none.
template <class P>
LEVIOSIM_TARGET_CALL typename P::F32 library_atan2(typename P::F32 y, typename P::F32 x) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const typename P::Function function("library_atan2");
  constexpr std::int32_t kFarApart = 60;  // binary digits, beyond which only one counts
  const I32 of_x = work::bits_of(x), of_y = work::bits_of(y);
  const I32 size_x = of_x & library::kNoSign, size_y = of_y & library::kNoSign;
  if (size_x > library::kInfinity || size_y > library::kInfinity) return x + y;
  if (of_x == library::kOne) return library::atan_of<P>(y);
  const bool is_left = static_cast<bool>(of_x < 0);
  const bool is_below = static_cast<bool>(of_y < 0);
  if (size_y == 0) return is_left ? (is_below ? F(-library::kPi) : F(library::kPi)) : y;
  if (size_x == 0) return is_below ? F(-library::kHalfPi) : F(library::kHalfPi);
  const I32 apart = (size_y - size_x) >> 23;
  F angle;
  if (apart > kFarApart) {
    angle = library::kHalfPi;
  } else if (is_left && apart < -kFarApart) {
    angle = 0.0f;
  } else {
    angle = library::atan_of<P>(work::abs(y / x));
  }
  if (!is_left) return is_below ? F(-angle) : angle;
  const F rest = angle - library::kPiTail;
  return is_below ? F(rest - library::kPi) : F(library::kPi - rest);
}

}  // namespace leviosim::vio::levio
