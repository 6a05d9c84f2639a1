// Singular values of square matrices as the released program finds them
// (PARAMETERS.md#linear-algebra): eigenvectors V of AᵀA, singular values as roots of its
// eigenvalues, U = A V S⁻¹ by two products, made orthonormal afterwards. An eigenvalue that
// rounding made negative gives a root that is not a number, which nobody notices.
//
// Left out: a case for singular matrices; see above.
#pragma once

#include "workload/levio/geometry/jacobi.h"
#include "workload/levio/geometry/product.h"
#include "workload/math/matrix.h"
#include "workload/math/target_compiler.h"

namespace leviosim::vio::levio {

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
