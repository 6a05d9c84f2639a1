// Singular values of square matrices as the released program finds them
// (PARAMETERS.md#linear-algebra): eigenvectors V of AᵀA, singular values as roots of its
// eigenvalues, U = A V S⁻¹ by two products, made orthonormal afterwards. An eigenvalue that
// rounding made negative gives a root that is not a number, which nobody notices.
//
// Left out: a case for singular matrices; see above.
#pragma once

#include "workload/levio/geometry/library_trig.h"
#include "workload/levio/geometry/product.h"
#include "workload/math/compilers.h"
#include "workload/math/kernel_kinds.h"
#include "workload/math/matrix.h"

namespace leviosim::vio::levio {

// Eigenvalues and eigenvectors of symmetric matrices as the released program finds them
// (PARAMETERS.md#linear-algebra): classical Jacobi, which searches the largest element before every
// rotation and makes no use of symmetry. The two new diagonal elements are computed in double
// precision (PARAMETERS.md#double-precision).
//
// The search begins with the first element off the diagonal. So a matrix that is not a number takes
// one rotation, which annihilates that element; nothing is larger than the zero afterwards.

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

inline constexpr int kMostSvdRotations = 10;
inline constexpr float kSvdTolerance = 1e-12f;  ///< absolute, of the elements of AᵀA

/// Makes the columns of a square matrix orthonormal, one after the other (modified Gram-Schmidt): a
/// root and n divisions each.
template <class P>
LEVIOSIM_TARGET_CALL void orthonormalise_columns(MatrixView<P> u) {
  using F = typename P::F32;
  const typename P::Function function("levio_orthonormalise_columns");
  const int n = u.rows();
  for (int i : P::byte_range(0, n)) {
    F length2 = 0.0f;
    for (int k : P::byte_range(0, n)) {
      const F x = u(k, i);
      length2 += x * x;
    }
    const F length = work::sqrt(length2);
    for (int k : P::byte_range(0, n)) u(k, i) /= length;
    for (int j : P::byte_range(i + 1, n)) {
      F along = 0.0f;
      for (int k : P::byte_range(0, n)) along += u(k, i) * u(k, j);
      for (int k : P::byte_range(0, n)) u(k, j) -= along * u(k, i);
    }
  }
}

/// A = U diag(S) Vᵀ, S descending. U and V may be reflections; of a singular A, all may be NaN.
/// Takes 4n² + n floats and n indices of scratch during the call.
/// @param a  n×n
/// @param u  n×n
/// @param s  n
/// @param v  n×n
template <class P>
LEVIOSIM_TARGET_CALL void svd(ConstMatrixView<P> a, MatrixView<P> u,
                              typename P::template Span<typename P::F32> s, MatrixView<P> v,
                              work::Arena& scratch) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using Indices = typename P::template Span<typename P::U16>;
  const typename P::Function function("levio_svd");
  const work::Arena::Frame frame(scratch);
  const int n = a.rows();
  const MatrixView<P> ata = alloc_matrix<P>(scratch, "AᵀA", n, n);
  const MatrixView<P> vectors = alloc_matrix<P>(scratch, "eigenvectors", n, n);
  const MatrixView<P> inverse = alloc_matrix<P>(scratch, "inverse singular values", n, n);
  const MatrixView<P> av = alloc_matrix<P>(scratch, "A V", n, n);
  const Indices order = scratch.alloc<Indices>("order of eigenvalues", n);
  product<P>(ata, transposed<P>(a), plain<P>(a));
  jacobi_eigen<P>(ata, vectors, kMostSvdRotations, F(kSvdTolerance));
  for (int i : P::byte_range(0, n)) s[i] = F(ata(i, i));
  sort_descending<P>(s, order);
  for (int i : P::byte_range(0, n)) {
    const MatrixView<P> column = vectors.from_column(I32(order[i]));
    for (int k : P::byte_range(0, n)) v(k, i) = F(column(k, 0));
  }
  fill<P>(inverse, 0.0f);
  for (int i : P::byte_range(0, n)) {
    const F singular = work::sqrt(F(s[i]));
    s[i] = singular;
    inverse(i, i) = F(1.0f) / singular;
  }
  product<P>(av, plain<P>(a), plain<P>(v));
  product<P>(u, plain<P>(av), plain<P>(inverse));
  orthonormalise_columns<P>(u);
}

}  // namespace leviosim::vio::levio
