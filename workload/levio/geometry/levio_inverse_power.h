// Eigenvector of the smallest eigenvalue as the released program finds it
// (PARAMETERS.md#linear-algebra): inverse power, each step of which copies the matrix and
// eliminates it in full. The copy and the work vectors lie on the call stack, so they are aligned.
//
// It stops when the cosine between two successive vectors comes out the same twice: the difference
// that it asks for is below what single precision can tell apart near 1.
//
// What the compiled code executes per counted operation depends on the size, so the two sizes that
// the pipeline has are named functions of their own.
//
// Left out: a test for a singular matrix. A pivot that vanishes leaves the solution zero, and its
// unit vector is not a number, which ends the iteration.
#pragma once

#include "workload/math/kernel_kinds.h"
#include "workload/math/matrix.h"
#include "workload/math/target_compiler.h"

namespace leviosim::vio::levio {

inline constexpr int kMostUnknowns = 9;
inline constexpr int kMostPowerSteps = 15;
inline constexpr float kPowerTolerance = 1e-10f;
inline constexpr float kSmallestPivot = 1e-12f;

namespace gauss {

/// Swaps the rows k and `other` of the n×n matrix, and their right-hand sides.
template <class P, class Matrix, class Vector>
void swap_rows(Matrix& a, Vector& b, int n, int k, typename P::I32 other) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const I32 row = other * I32(n);
  for (int c : P::byte_range(0, n)) {
    const I32 at = row + I32(c);
    const F moved = a[I32(k * n + c)];
    a[I32(k * n + c)] = F(a[at]);
    a[at] = moved;
  }
  const F moved = b[k];
  b[k] = F(b[other]);
  b[other] = moved;
}

/// Brings the largest |a(r, k)|, r ≥ k, to row k.
/// @return its magnitude
template <class P, class Matrix, class Vector>
typename P::F32 bring_pivot(Matrix& a, Vector& b, int n, int k) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  I32 row = k;
  F largest = work::abs(F(a[I32(k * n + k)]));
  for (int r : P::byte_range(k + 1, n)) {
    const F magnitude = work::abs(F(a[I32(r * n + k)]));
    if (magnitude > largest) {
      largest = magnitude;
      row = r;
    }
  }
  if (row != I32(k)) swap_rows<P>(a, b, n, k, row);
  return largest;
}

/// Brings A to triangular form and solves it, without a further copy. The released program has its
/// copies on the call stack with sizes of the moment, so the compiler knows no bound of them.
/// @param m    n×n, and rhs n: destroyed
/// @param x    n, zero: stays so if a pivot is below kSmallestPivot
template <class P>
LEVIOSIM_TARGET_CALL void solve_in_place(typename P::template Span<typename P::F32> m,
                                         typename P::template Span<typename P::F32> rhs,
                                         typename P::template Span<typename P::F32> x, int n) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  for (int k : P::byte_range(0, n)) {
    if (bring_pivot<P>(m, rhs, n, k) < F(kSmallestPivot)) return;
    for (int r : P::byte_range(k + 1, n)) {
      const F factor = F(m[I32(r * n + k)]) / F(m[I32(k * n + k)]);
      for (int c : P::byte_range(k, n)) m[I32(r * n + c)] -= factor * F(m[I32(k * n + c)]);
      rhs[r] -= factor * F(rhs[k]);
    }
  }
  for (int r : P::down_range(n - 1, 0)) {
    F sum = rhs[r];
    for (int c : P::byte_range(r + 1, n)) sum -= F(m[I32(r * n + c)]) * F(x[c]);
    x[r] = sum / F(m[I32(r * n + r)]);
  }
}

}  // namespace gauss

/// Solves A x = b by Gaussian elimination with partial pivoting on copies: a division per
/// eliminated row and per unknown. The pivot's own column is computed with the others. Sizes are
/// known at run time only, so addresses are computed.
/// @param a  n×n, n ≤ kMostUnknowns
/// @param x  n; zero if a pivot is below kSmallestPivot
template <class P>
LEVIOSIM_TARGET_CALL void solve_gauss(ConstMatrixView<P> a,
                                      typename P::template Span<const typename P::F32> b,
                                      typename P::template Span<typename P::F32> x) {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;
  const int n = a.rows();
  const typename P::OffloadRegion kernel(solve_of_size(n),
                                         factor_items(n, n) + substitution_items(n, n));
  typename P::template Array<F, kMostUnknowns * kMostUnknowns> m;
  typename P::template Array<F, kMostUnknowns> rhs;
  for (int i : P::byte_range(0, n * n)) m[i] = F(a.data()[i]);
  for (int i : P::byte_range(0, n)) {
    rhs[i] = F(b[i]);
    x[i] = 0.0f;
  }
  gauss::solve_in_place<P>(Span(m), Span(rhs), x, n);
}

namespace power {

/// solve_gauss() as a named function.
template <class P>
void solve(ConstMatrixView<P> a, typename P::template Span<const typename P::F32> b,
           typename P::template Span<typename P::F32> x) {
  if (a.rows() == kMostUnknowns) {
    const typename P::Function function("levio_solve_gauss_9x9");
    solve_gauss<P>(a, b, x);
  } else {
    const typename P::Function function("levio_solve_gauss_4x4");
    solve_gauss<P>(a, b, x);
  }
}

/// Divides every element by the norm: a root and n divisions.
template <class P>
void normalise(typename P::template Span<typename P::F32> x, int n) {
  using F = typename P::F32;
  F length2 = 0.0f;
  for (int i : P::byte_range(0, n)) {
    const F xi = x[i];
    length2 += xi * xi;
  }
  const F length = work::sqrt(length2);
  for (int i : P::byte_range(0, n)) x[i] = F(x[i]) / length;
}

/// smallest_eigenvector() with its work vectors, whose bounds the compiler does not know either.
template <class P>
LEVIOSIM_TARGET_CALL int iterate(ConstMatrixView<P> a,
                                 typename P::template Span<typename P::F32> last,
                                 typename P::template Span<typename P::F32> next,
                                 typename P::template Span<typename P::F32> x) {
  using F = typename P::F32;
  const int n = a.rows();
  for (int i : P::byte_range(0, n)) last[i] = 1.0f;
  normalise<P>(last, n);
  F last_cosine = 0.0f;
  int steps = 0;
  for (int step : P::range(0, kMostPowerSteps)) {
    solve<P>(a, last, next);
    normalise<P>(next, n);
    F cosine = 0.0f;
    for (int i : P::byte_range(0, n)) {
      cosine += next[i] * last[i];
      last[i] = F(next[i]);
    }
    steps = step + 1;
    const F change = work::abs(F(cosine - last_cosine));
    if (!(change >= F(kPowerTolerance))) break;
    last_cosine = cosine;
  }
  for (int i : P::byte_range(0, n)) x[i] = F(last[i]);
  return steps;
}

}  // namespace power

/// @param a  n×n, symmetric positive semi-definite, n ≤ kMostUnknowns
/// @param x  n; becomes the eigenvector with unit norm, of either sign; NaN if a pivot vanished
/// @return the number of steps taken
template <class P>
LEVIOSIM_TARGET_CALL int smallest_eigenvector(ConstMatrixView<P> a,
                                              typename P::template Span<typename P::F32> x) {
  using Span = typename P::template Span<typename P::F32>;
  const auto iterate = [&] {
    const typename P::OffloadRegion kernel(eigen_of_size(a.rows()), 1);
    typename P::template Array<typename P::F32, kMostUnknowns> last, next;
    return power::iterate<P>(a, Span(last), Span(next), x);
  };
  if (a.rows() == kMostUnknowns) {
    const typename P::Function function("levio_smallest_eigenvector_9x9");
    return iterate();
  }
  const typename P::Function function("levio_smallest_eigenvector_4x4");
  return iterate();
}

}  // namespace leviosim::vio::levio
