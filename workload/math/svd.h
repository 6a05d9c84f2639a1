// Singular value decomposition of small square matrices through the eigenvectors of AᵀA (classical
// Jacobi), as in the modelled library ("SVD of square matrices", paper section III-D).
//
// AᵀA squares the condition: right singular vectors whose singular values lie below about 3e-4 of
// the largest are known only as a group, in any order. That is enough for essential matrices and
// for Procrustes, where the smallest direction follows from the others.
//
// Left out: one-sided Jacobi and bidiagonalisation, which keep the condition.
#pragma once

#include "workload/math/jacobi.h"

namespace leviosim::vio {

/// g = AᵀA divided by its largest element, which is returned (it lies on the diagonal). A zero
/// matrix gives zeros.
template <class P>
LEVIOSIM_HOST_INLINE typename P::F32 normalised_square(MatrixView<P> g, ConstMatrixView<P> a) {
  using F = typename P::F32;
  const typename P::Function function("normalised_square");
  multiply_transposed<P>(g, a, a);
  F largest = 0.0f;
  for (int i : P::range(0, g.rows())) largest = work::max(largest, F(g(i, i)));
  F scale = 0.0f;
  if (largest > 0.0f) scale = F(1.0f) / largest;
  for (int i : P::range(0, g.rows() * g.cols())) g.data()[i] *= scale;
  return largest;
}

namespace svd {

/// Singular values below this part of the largest are rounding noise of A v.
inline constexpr float kDegenerate = 4e-6f;

/// Subtracts from column i of u its part along the columns before it; returns its remaining norm.
template <class P>
typename P::F32 orthogonalise(MatrixView<P> u, int i) {
  using F = typename P::F32;
  const int n = u.rows();
  for (int j : P::range(0, i)) {
    F along = 0.0f;
    for (int k : P::range(0, n)) along += u(k, j) * u(k, i);
    for (int k : P::range(0, n)) u(k, i) -= along * u(k, j);
  }
  F length2 = 0.0f;
  for (int k : P::range(0, n)) {
    const F x = u(k, i);
    length2 += x * x;
  }
  return work::sqrt(length2);
}

template <class P>
void scale_column(MatrixView<P> u, int i, typename P::F32 scale) {
  for (int k : P::range(0, u.rows())) u(k, i) *= scale;
}

/// Completes the orthonormal columns 0 … i-1 by one more: the first unit vector that keeps enough
/// of itself when their parts are taken away. At least one keeps (n-i)/n of its square.
template <class P>
void complete_column(MatrixView<P> u, int i) {
  using F = typename P::F32;
  const int n = u.rows();
  const float enough = 0.5f * static_cast<float>(n - i) / static_cast<float>(n);
  for (int axis : P::range(0, n)) {
    F kept = 1.0f;
    for (int j : P::range(0, i)) {
      const F x = u(axis, j);
      kept -= x * x;
    }
    if (kept < enough) continue;
    for (int k : P::range(0, n)) u(k, i) = k == axis ? 1.0f : 0.0f;
    scale_column<P>(u, i, F(1.0f) / orthogonalise<P>(u, i));
    return;
  }
}

}  // namespace svd

/// A = U diag(S) Vᵀ with orthonormal columns, S descending (see above for tiny ones). U and V may
/// be reflections.
/// @param a  n×n, n ≥ 2, any rank, finite
/// @param u  n×n, left singular vectors; those of vanishing singular values complete the basis
/// @param s  n
/// @param v  n×n
/// @param tolerance  of the off-diagonal elements of AᵀA relative to its largest element
template <class P>
LEVIOSIM_HOST_INLINE void svd_square(ConstMatrixView<P> a, MatrixView<P> u,
                                     typename P::template Span<typename P::F32> s, MatrixView<P> v,
                                     int max_rotations, typename P::F32 tolerance,
                                     DiagonalPrecision precision) {
  using F = typename P::F32;
  const typename P::Function function("svd_square");
  const int n = a.rows();
  normalised_square<P>(u, a);  // u holds AᵀA until the eigenvectors are known
  jacobi_eigen_classical<P>(u, v, max_rotations, tolerance, precision);
  sort_eigen_descending<P>(u, v);
  for (int i : P::range(0, n)) {
    for (int r : P::range(0, n)) {
      F sum = 0.0f;
      for (int c : P::range(0, n)) sum += a(r, c) * v(c, i);
      u(r, i) = sum;
    }
    const F length = svd::orthogonalise<P>(u, i);
    s[i] = length;
    if (length > svd::kDegenerate * s[0]) {
      svd::scale_column<P>(u, i, F(1.0f) / length);
    } else {
      svd::complete_column<P>(u, i);
    }
  }
}

inline constexpr int kSvd3Rotations = 10;
inline constexpr float kSvdTolerance = 1e-8f;

/// Singular values of a 3×3 matrix in registers; the work is done in memory on the call stack.
template <class P>
void svd3(const Mat3<P>& a, Mat3<P>& u, Vec3<P>& s, Mat3<P>& v, int max_rotations = kSvd3Rotations,
          typename P::F32 tolerance = kSvdTolerance,
          DiagonalPrecision precision = DiagonalPrecision::Double) {
  using F = typename P::F32;
  const typename P::Function function("svd3");
  typename P::template Array<F, 9> a_memory, u_memory, v_memory;
  typename P::template Array<F, 3> s_memory;
  for (int i = 0; i < 9; ++i) a_memory[i] = a.m[i / 3][i % 3];
  svd_square<P>(ConstMatrixView<P>(a_memory, 3, 3), MatrixView<P>(u_memory, 3, 3), s_memory,
                MatrixView<P>(v_memory, 3, 3), max_rotations, tolerance, precision);
  for (int i = 0; i < 9; ++i) {
    u.m[i / 3][i % 3] = F(u_memory[i]);
    v.m[i / 3][i % 3] = F(v_memory[i]);
  }
  s = {F(s_memory[0]), F(s_memory[1]), F(s_memory[2])};
}

}  // namespace leviosim::vio
