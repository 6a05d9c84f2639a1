// Eigenvalues and eigenvectors of symmetric matrices as the released program finds them
// (PARAMETERS.md#linear-algebra): classical Jacobi, which searches the largest element before every
// rotation and makes no use of symmetry. The two new diagonal elements are computed in double
// precision (PARAMETERS.md#double-precision).
//
// The search begins with the first element off the diagonal. So a matrix that is not a number takes
// one rotation, which annihilates that element; nothing is larger than the zero afterwards.
#pragma once

#include "workload/levio/geometry/library_trig.h"
#include "workload/math/compilers.h"
#include "workload/math/kernel_kinds.h"
#include "workload/math/matrix.h"
#include "workload/math/target_compiler.h"

namespace leviosim::vio::levio {

namespace jacobi {

template <class P>
struct Element {
  typename P::F32 magnitude;
  typename P::I32 row, column;
};

/// The largest |a(i, j)| above the diagonal, beginning with a(0, 1).
template <class P>
LEVIOSIM_HOST_INLINE Element<P> largest_off_diagonal(MatrixView<P> a) {
  using F = typename P::F32;
  const int n = a.rows();
  Element<P> largest{work::abs(F(a(0, 1))), 0, 1};
  for (int i : P::byte_range(0, n - 1))
    for (int j : P::byte_range(i + 1, n)) {
      const F magnitude = work::abs(F(a(i, j)));
      if (work::unlikely(magnitude > largest.magnitude)) largest = {magnitude, i, j};
    }
  return largest;
}

/// What a rotation puts in place of two diagonal elements.
template <class P>
struct Diagonal {
  typename P::F32 pp, qq;
};

/// c² app − 2 s c apq + s² aqq and s² app + 2 s c apq + c² aqq. The product of four is formed in
/// double precision once: 2 products, 5 sums, one of which doubles, 7 widenings, 2 narrowings.
template <class P>
Diagonal<P> rotated_diagonal(typename P::F32 c, typename P::F32 s, typename P::F32 app,
                             typename P::F32 apq, typename P::F32 aqq) {
  using F = typename P::F32;
  using F64 = typename P::F64;
  // One operation a statement: the order of operands is the compiler's, that of calls is not.
  const F64 wide_s = work::to_f64(s);
  const F64 twice = wide_s + wide_s;
  const F64 wide_c = work::to_f64(c);
  const F64 both = twice * wide_c;
  const F64 wide_apq = work::to_f64(apq);
  const F64 mixed = both * wide_apq;
  const F64 pp_first = work::to_f64(F(c * c * app));
  const F64 pp_partial = pp_first - mixed;
  const F64 pp_last = work::to_f64(F(s * s * aqq));
  const F64 pp = pp_partial + pp_last;
  const F64 qq_first = work::to_f64(F(s * s * app));
  const F64 qq_partial = qq_first + mixed;
  const F64 qq_last = work::to_f64(F(c * c * aqq));
  const F64 qq = qq_partial + qq_last;
  const F new_pp = work::to_f32(pp);
  const F new_qq = work::to_f32(qq);
  return {new_pp, new_qq};
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

/// Annihilates a(p, q) by a rotation of rows and columns, and turns the columns of v with it.
template <class P>
LEVIOSIM_HOST_INLINE void rotate(MatrixView<P> a, MatrixView<P> v, typename P::I32 p,
                                 typename P::I32 q) {
  using F = typename P::F32;
  const typename P::Function function("levio_jacobi_rotation");
  const auto row_p = a.row(p);
  const auto row_q = a.row(q);
  const F app = row_p[p], apq = row_p[q], aqq = row_q[q];
  const F angle = 0.5f * library_atan2<P>(2.0f * apq, aqq - app);
  const F c = library_cos<P>(angle);
  const F s = library_sin<P>(angle);
  rotate_rows<P>(row_p, row_q, c, s);
  rotate_columns<P>(a, p, q, c, s);
  const Diagonal<P> diagonal = rotated_diagonal<P>(c, s, app, apq, aqq);
  row_p[p] = diagonal.pp;
  row_q[q] = diagonal.qq;
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
LEVIOSIM_HOST_INLINE LEVIOSIM_TARGET_CALL int jacobi_eigen(MatrixView<P> a, MatrixView<P> v,
                                                           int max_rotations,
                                                           typename P::F32 tolerance) {
  const typename P::Function function("levio_jacobi_eigen");
  const typename P::OffloadRegion kernel(eigen_of_size(a.rows()), 1);
  set_identity<P>(v);
  int rotations = 0;
  for (int step : P::range(0, max_rotations)) {
    const jacobi::Element<P> largest = jacobi::largest_off_diagonal<P>(a);
    if (largest.magnitude < tolerance) break;
    jacobi::rotate<P>(a, v, largest.row, largest.column);
    rotations = step + 1;
  }
  return rotations;
}

/// Sorts `values` in descending order by selection; `order` becomes the place that each had.
template <class P, class Order>
void sort_descending(typename P::template Span<typename P::F32> values, Order order) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  const typename P::Function function("levio_sort_descending");
  const int n = values.size();
  for (int i : P::byte_range(0, n)) order[i] = work::narrow<U16>(I32(i));
  for (int i : P::byte_range(0, n - 1)) {
    I32 best = i;
    F largest = values[i];
    for (int j : P::byte_range(i + 1, n)) {
      const F candidate = values[j];
      if (candidate > largest) {
        largest = candidate;
        best = j;
      }
    }
    values[best] = F(values[i]);
    values[i] = largest;
    const I32 place = order[best];
    order[best] = work::narrow<U16>(I32(order[i]));
    order[i] = work::narrow<U16>(place);
  }
}

}  // namespace leviosim::vio::levio
