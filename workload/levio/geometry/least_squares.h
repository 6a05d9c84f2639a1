// Least squares by Householder reflections as the released program does it
// (PARAMETERS.md#linear-algebra): a reflector is normalised element by element, two norms per
// column, and applied to its own column too. A 6×4 system takes 22 divisions and 8 roots.
//
// Left out: a test whether the columns depend on each other; the result is then not a number.
#pragma once

#include "workload/math/compilers.h"
#include "workload/math/kernel_kinds.h"
#include "workload/math/matrix.h"
#include "workload/math/target_compiler.h"

namespace leviosim::vio::levio {

inline constexpr int kMostEquations = 6;

namespace qr {

/// Root of the sum of squares of elements first … size - 1.
template <class P, class Vector>
LEVIOSIM_HOST_INLINE typename P::F32 norm_from(Vector v, int first, int size) {
  using F = typename P::F32;
  F sum = 0.0f;
  for (int i : P::byte_range(first, size)) {
    const F x = v(i);
    sum += x * x;
  }
  return work::sqrt(sum);
}

/// Reflects column after column of the m×n matrix and the right-hand side, then substitutes. The
/// released program has its reflector on the call stack with a size of the moment, so the compiler
/// knows no bound of it.
/// @param reflector  m, work memory
template <class P>
LEVIOSIM_HOST_INLINE LEVIOSIM_TARGET_CALL void solve_in_place(
    MatrixView<P> a, typename P::template Span<typename P::F32> b,
    typename P::template Span<typename P::F32> reflector,
    typename P::template Span<typename P::F32> x) {
  using F = typename P::F32;
  const int m = a.rows(), n = a.cols();
  for (int k : P::byte_range(0, n)) {
    const F length = norm_from<P>([&](int r) { return F(a(r, k)); }, k, m);
    const F head = a(k, k);
    for (int r : P::byte_range(k, m)) reflector[r] = F(a(r, k));
    if (head > 0.0f)
      reflector[k] = head + length;
    else
      reflector[k] = head - length;
    const F size = norm_from<P>([&](int r) { return F(reflector[r]); }, k, m);
    for (int r : P::byte_range(k, m)) reflector[r] = F(reflector[r]) / size;
    for (int c : P::byte_range(k, n)) {
      F along = 0.0f;
      for (int r : P::byte_range(k, m)) along += reflector[r] * a(r, c);
      const F twice = 2.0f * along;
      for (int r : P::byte_range(k, m)) a(r, c) -= twice * reflector[r];
    }
    F along = 0.0f;
    for (int r : P::byte_range(k, m)) along += reflector[r] * b[r];
    const F twice = 2.0f * along;
    for (int r : P::byte_range(k, m)) b[r] -= twice * reflector[r];
  }
  for (int r : P::down_range(n - 1, 0)) {
    F sum = b[r];
    for (int c : P::byte_range(r + 1, n)) sum -= a(r, c) * x[c];
    x[r] = sum / a(r, r);
  }
}

}  // namespace qr

/// x of min |A x − b|.
/// @param a  m×n, n ≤ m ≤ kMostEquations, destroyed
/// @param b  m, destroyed
/// @param x  n
template <class P>
LEVIOSIM_HOST_INLINE LEVIOSIM_TARGET_CALL void least_squares(
    MatrixView<P> a, typename P::template Span<typename P::F32> b,
    typename P::template Span<typename P::F32> x) {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;
  const typename P::Function function("levio_least_squares");
  const int m = a.rows(), n = a.cols();
  const typename P::OffloadRegion kernel(solve_of_size(n),
                                         factor_items(m, n) + substitution_items(m, n));
  typename P::template Array<F, kMostEquations> reflector;
  qr::solve_in_place<P>(a, b, Span(reflector), x);
}

}  // namespace leviosim::vio::levio
