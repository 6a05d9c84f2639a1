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

#include "sim/work/policy.h"
#include "workload/math/vec.h"

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

// ---- rotations: exp and log of SO(3), angles in radians ----

namespace trig {

/// R = I + a [w]× + b [w]×²
template <class P>
Mat3<P> rodrigues(const Vec3<P>& w, typename P::F32 a, typename P::F32 b) {
  using F = typename P::F32;
  // [w]×² = w wᵀ − |w|² I
  const F xy = b * (w.x * w.y), xz = b * (w.x * w.z), yz = b * (w.y * w.z);
  const F xx = w.x * w.x, yy = w.y * w.y, zz = w.z * w.z;
  const F one = 1.0f;
  return {{{one - b * (yy + zz), xy - a * w.z, xz + a * w.y},
           {xy + a * w.z, one - b * (xx + zz), yz - a * w.x},
           {xz - a * w.y, yz + a * w.x, one - b * (xx + yy)}}};
}

/// Below this θ² the series in θ² are used; their next terms are beneath single precision.
inline constexpr float kSmallAngle2 = 1e-3f;

}  // namespace trig

/// Rotation by |w| about w. The half angle avoids the cancellation of 1 − cos.
template <class P>
Mat3<P> so3_exp(const Vec3<P>& w) {
  using F = typename P::F32;
  const typename P::Function function("so3_exp");
  const F theta2 = dot(w, w);
  if (theta2 < trig::kSmallAngle2) {
    const F a = (theta2 * F(1.0f / 120.0f) - F(1.0f / 6.0f)) * theta2 + F(1.0f);
    const F b = theta2 * F(-1.0f / 24.0f) + F(0.5f);
    return trig::rodrigues<P>(w, a, b);
  }
  const F theta = work::sqrt(theta2);
  const F inverse = F(1.0f) / theta;
  const SinCos<P> half = sincos_of<P>(theta * 0.5f);
  const F s = half.sin * inverse;
  return trig::rodrigues<P>(w, 2.0f * (s * half.cos), 2.0f * (s * s));
}

namespace trig {

template <class P>
struct Quaternion {
  typename P::F32 w, x, y, z;
};

/// 4|q_k|·(w, x, y, z) for the largest component k of the unit quaternion of R, which is at least
/// 1/2, so that nothing cancels.
template <class P>
Quaternion<P> scaled_quaternion(const Mat3<P>& R) {
  using F = typename P::F32;
  const F xx = R.m[0][0], yy = R.m[1][1], zz = R.m[2][2];
  const F trace = xx + yy + zz;
  const F one = 1.0f;
  if (trace > 0.0f)
    return {one + trace, R.m[2][1] - R.m[1][2], R.m[0][2] - R.m[2][0], R.m[1][0] - R.m[0][1]};
  if (xx > yy && xx > zz)
    return {R.m[2][1] - R.m[1][2], one + xx - yy - zz, R.m[0][1] + R.m[1][0],
            R.m[0][2] + R.m[2][0]};
  if (yy > zz)
    return {R.m[0][2] - R.m[2][0], R.m[0][1] + R.m[1][0], one + yy - xx - zz,
            R.m[1][2] + R.m[2][1]};
  return {R.m[1][0] - R.m[0][1], R.m[0][2] + R.m[2][0], R.m[1][2] + R.m[2][1], one + zz - xx - yy};
}

}  // namespace trig

/// Rotation vector w with |w| ≤ π and so3_exp(w) = R. Accurate at every angle; at exactly π one of
/// the two opposite vectors is returned.
template <class P>
Vec3<P> so3_log(const Mat3<P>& R) {
  using F = typename P::F32;
  const typename P::Function function("so3_log");
  trig::Quaternion<P> q = trig::scaled_quaternion<P>(R);
  if (q.w < 0.0f) q = {-q.w, -q.x, -q.y, -q.z};
  const Vec3<P> v{q.x, q.y, q.z};
  const F v2 = dot(v, v);
  // 2 atan(|v|/w)/|v|. Below |v|/w = 1e-4 the arc tangent is its argument, and |v| may underflow.
  const F w2 = q.w * q.w;
  if (v2 < w2 * F(1e-8f)) return v * F(2.0f / q.w);
  const F length = work::sqrt(v2);
  return v * F(2.0f * atan2_of<P>(length, q.w) / length);
}

/// Jr(w) with exp(w + δ) ≈ exp(w) exp(Jr(w) δ). Accurate for |w| < 2π.
template <class P>
Mat3<P> so3_right_jacobian(const Vec3<P>& w) {
  using F = typename P::F32;
  const typename P::Function function("so3_right_jacobian");
  const F theta2 = dot(w, w);
  if (theta2 < trig::kSmallAngle2) {
    const F a = theta2 * F(1.0f / 24.0f) - F(0.5f);
    const F b = theta2 * F(-1.0f / 120.0f) + F(1.0f / 6.0f);
    return trig::rodrigues<P>(w, a, b);
  }
  const F theta = work::sqrt(theta2);
  const F inverse = F(1.0f) / theta;
  const SinCos<P> half = sincos_of<P>(theta * 0.5f);
  const F s = half.sin * inverse;
  const F b = (F(1.0f) - F(2.0f) * (s * half.cos)) * (inverse * inverse);
  return trig::rodrigues<P>(w, F(-2.0f) * (s * s), b);
}

/// The inverse of Jr(w), used for d log(R exp(δ)) / dδ. Accurate for |w| < 2π, where it is
/// singular.
template <class P>
Mat3<P> so3_right_jacobian_inverse(const Vec3<P>& w) {
  using F = typename P::F32;
  const typename P::Function function("so3_right_jacobian_inverse");
  const F theta2 = dot(w, w);
  const F a = 0.5f;
  if (theta2 < trig::kSmallAngle2) {
    const F b = theta2 * F(1.0f / 720.0f) + F(1.0f / 12.0f);
    return trig::rodrigues<P>(w, a, b);
  }
  // 1/θ² − cot(θ/2)/(2θ)
  const F theta = work::sqrt(theta2);
  const SinCos<P> half = sincos_of<P>(theta * 0.5f);
  const F b = (F(1.0f) - (theta * 0.5f) * half.cos / half.sin) / theta2;
  return trig::rodrigues<P>(w, a, b);
}

}  // namespace leviosim::vio
