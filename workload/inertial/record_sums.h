// ---- sums, scaled sums and products with a skew matrix, without the zeros of skew() ----
#pragma once

#include "workload/math/vec.h"

namespace leviosim::vio {

template <class P>
Mat3<P> operator+(const Mat3<P>& a, const Mat3<P>& b) {
  Mat3<P> c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) c.m[i][j] = a.m[i][j] + b.m[i][j];
  return c;
}

/// a + s b
template <class P>
Mat3<P> add_scaled(const Mat3<P>& a, typename P::F32 s, const Mat3<P>& b) {
  Mat3<P> c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) c.m[i][j] = a.m[i][j] + s * b.m[i][j];
  return c;
}

/// s a
template <class P>
Mat3<P> scaled(typename P::F32 s, const Mat3<P>& a) {
  Mat3<P> c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) c.m[i][j] = s * a.m[i][j];
  return c;
}

/// a [v]×
template <class P>
Mat3<P> times_skew(const Mat3<P>& a, const Vec3<P>& v) {
  Mat3<P> c;
  for (int i = 0; i < 3; ++i) {
    const Vec3<P> row = cross(a.row(i), v);
    c.m[i][0] = row.x;
    c.m[i][1] = row.y;
    c.m[i][2] = row.z;
  }
  return c;
}

/// a + s I
template <class P>
Mat3<P> add_diagonal(Mat3<P> a, typename P::F32 s) {
  for (int i = 0; i < 3; ++i) a.m[i][i] += s;
  return a;
}

/// One Newton step towards the nearest rotation, against the drift of many small updates.
template <class P>
Mat3<P> orthonormalised(const Mat3<P>& R) {
  using F = typename P::F32;
  const Mat3<P> RtR = transpose(R) * R;
  return R * add_diagonal<P>(scaled<P>(F(-0.5f), RtR), F(1.5f));
}

}  // namespace leviosim::vio
