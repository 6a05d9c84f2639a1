// Small vectors and rotation matrices as *register values*: their components are plain scalars of
// the policy, so reading them counts no load, but products of two matrices load and store. Anything
// larger than a 3×3 lives in memory (matrix.h).
#pragma once

#include "sim/work/policy.h"
#include "workload/math/pinhole_camera.h"

namespace leviosim::vio {

template <class P>
struct Vec2 {
  typename P::F32 x, y;
};

template <class P>
struct Vec3 {
  using F = typename P::F32;
  F x, y, z;

  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3 operator*(const Vec3& a, F s) { return {a.x * s, a.y * s, a.z * s}; }
  friend Vec3 operator*(F s, const Vec3& a) { return a * s; }
};

template <class P>
typename P::F32 dot(const Vec3<P>& a, const Vec3<P>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class P>
Vec3<P> cross(const Vec3<P>& a, const Vec3<P>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class P>
typename P::F32 norm(const Vec3<P>& a) {
  return work::sqrt(typename P::F32(dot(a, a)));
}

/// 3×3 matrix, m[row][column].
template <class P>
struct Mat3 {
  using F = typename P::F32;
  F m[3][3];

  static Mat3 identity() { return {{{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}}}; }
  static Mat3 zero() { return {{{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}}}; }
  Vec3<P> row(int r) const { return {m[r][0], m[r][1], m[r][2]}; }
  Vec3<P> column(int c) const { return {m[0][c], m[1][c], m[2][c]}; }
};

template <class P>
Vec3<P> operator*(const Mat3<P>& a, const Vec3<P>& v) {
  return {dot(a.row(0), v), dot(a.row(1), v), dot(a.row(2), v)};
}
/// A function of its own, since two matrices and their product fit into no core's registers: it
/// loads its operands, one row and one matrix at a time, and stores the product.
template <class P>
[[gnu::noinline]] Mat3<P> operator*(const Mat3<P>& a, const Mat3<P>& b) {
  using F = typename P::F32;
  using Row = typename P::template Span<const F>;
  const typename P::Function function("mat3_multiply");
  const Mat3<P> right{{{F(Row(b.m[0], 3)[0]), F(Row(b.m[0], 3)[1]), F(Row(b.m[0], 3)[2])},
                       {F(Row(b.m[1], 3)[0]), F(Row(b.m[1], 3)[1]), F(Row(b.m[1], 3)[2])},
                       {F(Row(b.m[2], 3)[0]), F(Row(b.m[2], 3)[1]), F(Row(b.m[2], 3)[2])}}};
  Mat3<P> c;
  for (int i : P::range(0, 3)) {
    const Row row(a.m[i], 3);
    const Vec3<P> left{F(row[0]), F(row[1]), F(row[2])};
    const typename P::template Span<F> to(c.m[i], 3);
    for (int j = 0; j < 3; ++j) to[j] = F(dot(left, right.column(j)));
  }
  return c;
}
template <class P>
Mat3<P> transpose(const Mat3<P>& a) {
  return {{{a.m[0][0], a.m[1][0], a.m[2][0]},
           {a.m[0][1], a.m[1][1], a.m[2][1]},
           {a.m[0][2], a.m[1][2], a.m[2][2]}}};
}
template <class P>
typename P::F32 determinant(const Mat3<P>& a) {
  return dot(a.row(0), cross(a.row(1), a.row(2)));
}
/// The matrix [v]× with [v]× w = v × w.
template <class P>
Mat3<P> skew(const Vec3<P>& v) {
  return {{{0.0f, -v.z, v.y}, {v.z, 0.0f, -v.x}, {-v.y, v.x, 0.0f}}};
}

/// Rigid transform: T_a_b maps coordinates in frame b to frame a, x_a = R x_b + t.
template <class P>
struct Pose {
  Mat3<P> R;
  Vec3<P> t;

  static Pose identity() { return {Mat3<P>::identity(), {0.0f, 0.0f, 0.0f}}; }
  friend Vec3<P> operator*(const Pose& T, const Vec3<P>& x) { return T.R * x + T.t; }
  friend Pose operator*(const Pose& A, const Pose& B) { return {A.R * B.R, A.R * B.t + A.t}; }
};

template <class P>
Pose<P> inverse(const Pose<P>& T) {
  const Mat3<P> Rt = transpose(T.R);
  return {Rt, -(Rt * T.t)};
}

}  // namespace leviosim::vio
