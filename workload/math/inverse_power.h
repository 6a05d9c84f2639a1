// Eigenvector of the smallest eigenvalue by inverse power iteration (PARAMETERS.md#linear-algebra),
// for triangulation; the 8-point algorithm has its own
// (workload/levio/geometry/levio_inverse_power.h). Every step solves A y = x by a full Gaussian
// elimination; the factors are not kept, as in the modelled library.
//
// A singular A is what callers hope for: pivots that vanish are replaced by 1e-9 of the largest
// diagonal element, beneath the rounding of the elimination, so that y points along the null space.
//
// Left out: shifts. If the two smallest eigenvalues are close, the result is a mixture of theirs.
#pragma once

#include "workload/math/solve.h"

namespace leviosim::vio {

/// @param a  n×n, symmetric positive semi-definite, not zero
/// @param x  n; becomes the eigenvector with unit norm, of either sign
/// @param scratch  takes n² + 2n floats during the call
/// @param tolerance  stop when no component changes by more than this between steps
/// @return the number of steps taken
template <class P>
int smallest_eigenvector(ConstMatrixView<P> a, typename P::template Span<typename P::F32> x,
                         work::Arena& scratch, int max_steps, typename P::F32 tolerance) {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;
  const typename P::Function function("smallest_eigenvector");
  const int n = a.rows();
  const typename P::OffloadRegion kernel(eigen_of_size(n), 1);
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> lu = alloc_matrix<P>(scratch, "elimination", n, n);
  const Span b = scratch.alloc<Span>("right-hand side", n);
  const Span y = scratch.alloc<Span>("solution", n);

  F largest = 0.0f;
  for (int i : P::range(0, n)) {
    largest = work::max(largest, F(a(i, i)));
    x[i] = 1.0f;
  }
  const F smallest_pivot = largest * 1e-9f + 1e-30f;
  int steps = 0;
  for (int step : P::range(0, max_steps)) {
    copy<P>(lu, a);
    for (int i : P::range(0, n)) b[i] = F(x[i]);
    solve_gauss<P>(lu, b, y, smallest_pivot);
    steps = step + 1;

    F length2 = 0.0f, along = 0.0f;
    for (int i : P::range(0, n)) {
      const F yi = y[i];
      length2 += yi * yi;
      along += yi * x[i];
    }
    F scale = F(1.0f) / work::sqrt(length2);
    if (along < 0.0f) scale = -scale;  // so that the change is not a mere change of sign
    F change = 0.0f;
    for (int i : P::range(0, n)) {
      const F xi = y[i] * scale;
      change = work::max(change, work::abs(F(xi - x[i])));
      x[i] = xi;
    }
    if (change < tolerance) break;
  }
  return steps;
}

}  // namespace leviosim::vio
