// Eigenvalues and eigenvectors of small symmetric matrices by the classical Jacobi method: every
// rotation annihilates the largest off-diagonal element, which is searched for first. Each rotation
// takes one arc tangent, one cosine and one sine (PARAMETERS.md#linear-algebra).
//
// Left out: cheaper rotations without trigonometry, and cyclic order, which needs no search.
#pragma once

#include "workload/math/host_hints.h"
#include "workload/math/kernel_kinds.h"
#include "workload/math/matrix.h"
#include "workload/math/trig.h"

namespace leviosim::vio {

/// In what precision the two new diagonal elements of a rotation are computed. `Double` is what a
/// double literal in a single-precision expression costs (PARAMETERS.md#double-precision):
/// products and sums in an emulation library on FP32-only cores.
enum class DiagonalPrecision { Single, Double };

namespace jacobi {

template <class P>
struct Element {
  typename P::F32 magnitude;
  typename P::I32 row, column;
};

/// The largest |a(i, j)| above the diagonal.
template <class P>
LEVIOSIM_HOST_INLINE Element<P> largest_off_diagonal(MatrixView<P> a) {
  using F = typename P::F32;
  const int n = a.rows();
  Element<P> largest{0.0f, 0, 1};
  for (int i : P::range(0, n - 1))
    for (int j : P::range(i + 1, n)) {
      const F magnitude = work::abs(F(a(i, j)));
      if (work::unlikely(magnitude > largest.magnitude)) largest = {magnitude, i, j};
    }
  return largest;
}

/// c² app − 2 s c apq + s² aqq
template <class P>
LEVIOSIM_HOST_INLINE typename P::F32 rotated_diagonal(typename P::F32 c, typename P::F32 s,
                                                      typename P::F32 app, typename P::F32 apq,
                                                      typename P::F32 aqq,
                                                      DiagonalPrecision precision) {
  using F = typename P::F32;
  using F64 = typename P::F64;
  const F first = c * c * app;
  const F last = s * s * aqq;
  if (precision == DiagonalPrecision::Single) {
    const F cross = 2.0f * s * c;
    return first - cross * apq + last;
  }
  // One routine a statement: the order of operands is the compiler's, that of library calls is not.
  F64 cross = work::to_f64(s);
  cross = F64(2.0) * cross;
  const F64 c64 = work::to_f64(c);
  cross = cross * c64;
  const F64 apq64 = work::to_f64(apq);
  cross = cross * apq64;
  const F64 first64 = work::to_f64(first);
  const F64 last64 = work::to_f64(last);
  return work::to_f32(F64(first64 - cross + last64));
}

/// (x, y) ← (c x − s y, s x + c y) for the elements of two rows.
template <class P>
LEVIOSIM_HOST_INLINE void rotate_rows(typename P::template Span<typename P::F32> x_row,
                                      typename P::template Span<typename P::F32> y_row,
                                      typename P::F32 c, typename P::F32 s) {
  using F = typename P::F32;
  for (int k : P::range(0, x_row.size())) {
    const F x = x_row[k];
    const F y = y_row[k];
    x_row[k] = c * x - s * y;
    y_row[k] = s * x + c * y;
  }
}

/// Rotates columns p and q of a.
template <class P>
LEVIOSIM_HOST_INLINE void rotate_columns(MatrixView<P> a, typename P::I32 p, typename P::I32 q,
                                         typename P::F32 c, typename P::F32 s) {
  using F = typename P::F32;
  const MatrixView<P> x_column = a.from_column(p);
  const MatrixView<P> y_column = a.from_column(q);
  for (int k : P::range(0, a.rows())) {
    const F x = x_column(k, 0);
    const F y = y_column(k, 0);
    x_column(k, 0) = c * x - s * y;
    y_column(k, 0) = s * x + c * y;
  }
}

/// Annihilates a(p, q) by a similarity rotation of a, which stays symmetric to the last bit.
template <class P>
LEVIOSIM_HOST_INLINE void rotate(MatrixView<P> a, MatrixView<P> v, typename P::I32 p,
                                 typename P::I32 q, DiagonalPrecision precision) {
  using F = typename P::F32;
  const typename P::Function function("jacobi_rotation");
  const auto row_p = a.row(p);
  const auto row_q = a.row(q);
  const F app = row_p[p], apq = row_p[q], aqq = row_q[q];
  const F angle = 0.5f * atan2_of<P>(2.0f * apq, aqq - app);
  const F c = cos_of<P>(angle);
  const F s = sin_of<P>(angle);
  rotate_rows<P>(row_p, row_q, c, s);
  rotate_columns<P>(a, p, q, c, s);
  row_p[p] = rotated_diagonal<P>(c, s, app, apq, aqq, precision);
  row_q[q] = rotated_diagonal<P>(s, -c, app, apq, aqq, precision);
  row_p[q] = 0.0f;
  row_q[p] = 0.0f;
  rotate_columns<P>(v, p, q, c, s);
}

}  // namespace jacobi

template <class P>
void set_identity(MatrixView<P> a) {
  for (int i : P::range(0, a.rows()))
    for (int j : P::range(0, a.cols())) a(i, j) = i == j ? 1.0f : 0.0f;
}

/// A = V diag(λ) Vᵀ. Stops when the largest off-diagonal element is below `tolerance` (absolute)
/// or after `max_rotations`. Eigenvalues are not sorted.
/// @param a  n×n symmetric, n ≥ 2; destroyed: its diagonal becomes the eigenvalues
/// @param v  n×n; its columns become the eigenvectors
/// @return the number of rotations
template <class P>
LEVIOSIM_HOST_INLINE int jacobi_eigen_classical(MatrixView<P> a, MatrixView<P> v, int max_rotations,
                                                typename P::F32 tolerance,
                                                DiagonalPrecision precision) {
  const typename P::Function function("jacobi_eigen_classical");
  const typename P::OffloadRegion kernel(eigen_of_size(a.rows()), 1);
  set_identity<P>(v);
  int rotations = 0;
  for (int step : P::range(0, max_rotations)) {
    const jacobi::Element<P> largest = jacobi::largest_off_diagonal<P>(a);
    if (largest.magnitude < tolerance) break;
    jacobi::rotate<P>(a, v, largest.row, largest.column, precision);
    rotations = step + 1;
  }
  return rotations;
}

/// Sorts the diagonal of `a` in descending order, and the columns of `v` with it. The other
/// elements of `a` are left where they are.
template <class P>
void sort_eigen_descending(MatrixView<P> a, MatrixView<P> v) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const typename P::Function function("sort_eigen_descending");
  for (int i : P::range(0, a.rows() - 1)) {
    I32 best = i;
    F largest = a(i, i);
    for (int j : P::range(i + 1, a.rows())) {
      const F candidate = a(j, j);
      if (candidate > largest) {
        largest = candidate;
        best = j;
      }
    }
    if (best == i) continue;
    a(best, best) = F(a(i, i));
    a(i, i) = largest;
    const MatrixView<P> other = v.from_column(best);
    for (int k : P::range(0, v.rows())) {
      const F moved = v(k, i);
      v(k, i) = F(other(k, 0));
      other(k, 0) = moved;
    }
  }
}

}  // namespace leviosim::vio
