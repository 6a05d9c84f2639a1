// Sine, cosine, arc tangent and rotations in counted single precision. Own implementations, so that
// every host computes the same bits and the target's cost is counted operation by operation.
//
// Method: reduction to |r| ≤ π/4 (sine, cosine) or to [0, 1] (arc tangent), then a polynomial whose
// coefficients are the minimax ones for the relative error (Remez exchange in 50 digits, rounded to
// single precision). Errors of the polynomials: sine 4e-9, cosine 1e-10, arc tangent 1.5e-8; what
// remains is rounding. Measured against double precision: sine and cosine 1e-7 absolute for
// |x| ≤ 8192, arc tangent 3e-7 absolute. Tests hold 1.5e-7 and 4e-7.
//
// Left out: |x| > 8192 (the reduction loses accuracy), infinities and NaN.
#pragma once

namespace leviosim::vio {

template <class P>
struct SinCos {
  typename P::F32 sin, cos;
};

namespace trig {

inline constexpr float kPi = 3.14159265f;
inline constexpr float kHalfPi = 1.57079633f;

/// x = quadrant · π/2 + r with |r| ≤ π/4 and a bit.
template <class P>
struct Reduced {
  typename P::F32 r;
  typename P::U32 quadrant;  ///< modulo 4: only its two lowest bits mean something
};

template <class P>
Reduced<P> reduce(typename P::F32 x) {
  using F = typename P::F32;
  constexpr float kTwoOverPi = 0.636619747f;
  // Adding 1.5 · 2^23 leaves no fraction bits: it rounds to the nearest integer, whose low bits are
  // then the low bits of the sum.
  constexpr float kRounder = 12582912.0f;
  // π/2 in three parts; the first two have 11 bits at most, so that their products are exact.
  constexpr float kFirst = 1.5703125f, kSecond = 4.83751297e-4f, kThird = 7.54978995e-8f;
  const F shifted = x * kTwoOverPi + F(kRounder);
  const F turns = shifted - kRounder;
  F r = x - turns * kFirst;
  r = r - turns * kSecond;
  r = r - turns * kThird;
  return {r, typename P::U32(work::bits_of(shifted))};
}

/// sin(r) and cos(r) for |r| ≤ π/4.
template <class P>
typename P::F32 sin_reduced(typename P::F32 r) {
  using F = typename P::F32;
  const F t = r * r;
  const F s = (t * F(-1.95166562e-4f) + F(8.33217334e-3f)) * t + F(-0.166666552f);
  const F cubed = t * r;
  return cubed * s + r;
}
template <class P>
typename P::F32 cos_reduced(typename P::F32 r) {
  using F = typename P::F32;
  const F t = r * r;
  const F c = (t * F(2.44377297e-5f) + F(-1.38873619e-3f)) * t + F(4.16666456e-2f);
  const F base = t * F(-0.5f) + F(1.0f);
  const F squared = t * t;
  return squared * c + base;
}

/// sin(r + quadrant · π/2)
template <class P>
typename P::F32 sin_in_quadrant(const Reduced<P>& a) {
  using F = typename P::F32;
  F y;
  if ((a.quadrant & 1u) != 0u) {
    y = cos_reduced<P>(a.r);
  } else {
    y = sin_reduced<P>(a.r);
  }
  if ((a.quadrant & 2u) != 0u) y = -y;
  return y;
}

/// atan(q) for 0 ≤ q ≤ 1.
template <class P>
typename P::F32 atan_unit(typename P::F32 q) {
  using F = typename P::F32;
  const F t = q * q;
  F s = t * F(2.97459611e-3f) + F(-1.65812057e-2f);
  s = s * t + F(4.35535721e-2f);
  s = s * t + F(-7.58058056e-2f);
  s = s * t + F(0.106789418f);
  s = s * t + F(-0.142142087f);
  s = s * t + F(0.199941367f);
  s = s * t + F(-0.333331674f);
  const F cubed = t * q;
  return cubed * s + q;
}

}  // namespace trig

/// Sine of x radians.
template <class P>
typename P::F32 sin_of(typename P::F32 x) {
  const typename P::Function function("sin");
  return trig::sin_in_quadrant<P>(trig::reduce<P>(x));
}

/// Cosine of x radians.
template <class P>
typename P::F32 cos_of(typename P::F32 x) {
  const typename P::Function function("cos");
  trig::Reduced<P> a = trig::reduce<P>(x);
  a.quadrant += 1u;
  return trig::sin_in_quadrant<P>(a);
}

/// Sine and cosine with one reduction of the angle; the bits of sin_of and cos_of.
template <class P>
SinCos<P> sincos_of(typename P::F32 x) {
  using F = typename P::F32;
  const typename P::Function function("sincos");
  const trig::Reduced<P> a = trig::reduce<P>(x);
  F s = trig::sin_reduced<P>(a.r);
  F c = trig::cos_reduced<P>(a.r);
  if ((a.quadrant & 1u) != 0u) {
    const F swapped = s;
    s = c;
    c = -swapped;
  }
  if ((a.quadrant & 2u) != 0u) {
    s = -s;
    c = -c;
  }
  return {s, c};
}

/// Angle of (x, y) in radians, in [-π, π]; 0 for (0, 0). Zeros have no sign here.
template <class P>
typename P::F32 atan2_of(typename P::F32 y, typename P::F32 x) {
  using F = typename P::F32;
  const typename P::Function function("atan2");
  const F ax = work::abs(x);
  const F ay = work::abs(y);
  const F large = work::max(ax, ay);
  if (large == 0.0f) return 0.0f;
  F angle = trig::atan_unit<P>(work::min(ax, ay) / large);
  if (ay > ax) angle = trig::kHalfPi - angle;
  if (x < 0.0f) angle = trig::kPi - angle;
  if (y < 0.0f) angle = -angle;
  return angle;
}

}  // namespace leviosim::vio
