// Rigid transforms that leave the vertical as it is: a turn about the world's z axis, which points
// up, and a translation. Gravity fixes the other two angles of a pose, so drift has these four
// degrees of freedom only.
#pragma once

#include "workload/math/trig.h"
#include "workload/math/vec.h"

namespace leviosim::vio {

/// x → Rz(yaw) x + t
template <class P>
struct YawTransform {
  using F = typename P::F32;
  F yaw;  ///< [rad]
  Vec3<P> t;

  static YawTransform identity() { return {0.0f, {0.0f, 0.0f, 0.0f}}; }
};

/// Rz x, given the turn's sine and cosine.
template <class P>
Vec3<P> turned(const SinCos<P>& turn, const Vec3<P>& x) {
  return {turn.cos * x.x - turn.sin * x.y, turn.sin * x.x + turn.cos * x.y, x.z};
}

template <class P>
Vec3<P> operator*(const YawTransform<P>& T, const Vec3<P>& x) {
  return turned<P>(sincos_of<P>(T.yaw), x) + T.t;
}

template <class P>
Pose<P> operator*(const YawTransform<P>& T, const Pose<P>& pose) {
  const SinCos<P> turn = sincos_of<P>(T.yaw);
  Pose<P> result;
  for (int c = 0; c < 3; ++c) {
    const Vec3<P> column = turned<P>(turn, pose.R.column(c));
    result.R.m[0][c] = column.x;
    result.R.m[1][c] = column.y;
    result.R.m[2][c] = column.z;
  }
  result.t = turned<P>(turn, pose.t) + T.t;
  return result;
}

/// The transform of this yaw that maps `from` to `to`.
template <class P>
YawTransform<P> yaw_transform_between(typename P::F32 yaw, const Vec3<P>& from, const Vec3<P>& to) {
  return {yaw, to - turned<P>(sincos_of<P>(yaw), from)};
}

/// The same angle in −π … π, for one that is off by a turn at most.
template <class P>
typename P::F32 wrapped(typename P::F32 angle) {
  using F = typename P::F32;
  if (angle > F(trig::kPi)) return angle - F(2 * trig::kPi);
  if (angle < F(-trig::kPi)) return angle + F(2 * trig::kPi);
  return angle;
}

}  // namespace leviosim::vio
