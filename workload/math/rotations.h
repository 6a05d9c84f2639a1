// ---- rotations: exp and log of SO(3), angles in radians ----
#pragma once

#include "workload/math/trig.h"
#include "workload/math/vec.h"

namespace leviosim::vio {

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
