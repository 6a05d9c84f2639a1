// Small vectors, matrices and poses at fixed places of a record of floats in memory: loading one
// counts its loads, storing it its stores.
#pragma once

#include "workload/math/vec.h"

namespace leviosim::vio {

inline constexpr int kPoseFloats = 12;  ///< rotation row by row, then translation

/// Three consecutive floats at `at`.
template <class P, class Span>
Vec3<P> load_vec3(const Span& from, int at) {
  return {from[at], from[at + 1], from[at + 2]};
}
template <class P, class Span>
void store_vec3(const Span& to, int at, const Vec3<P>& v) {
  to[at] = v.x;
  to[at + 1] = v.y;
  to[at + 2] = v.z;
}

/// 3×3 matrix whose rows start `stride` floats apart.
template <class P, class Span>
Mat3<P> load_mat3(const Span& from, int at, int stride = 3) {
  Mat3<P> a;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) a.m[r][c] = from[at + r * stride + c];
  return a;
}
template <class P, class Span>
void store_mat3(const Span& to, int at, const Mat3<P>& a, int stride = 3) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) to[at + r * stride + c] = a.m[r][c];
}

template <class P, class Span>
Pose<P> load_pose(const Span& from, int at) {
  return {load_mat3<P>(from, at), load_vec3<P>(from, at + 9)};
}
template <class P, class Span>
void store_pose(const Span& to, int at, const Pose<P>& T) {
  store_mat3<P>(to, at, T.R);
  store_vec3<P>(to, at + 9, T.t);
}

}  // namespace leviosim::vio
