// Cholesky factorisation as the released program does it (PARAMETERS.md#optimiser): the reciprocal
// of a diagonal element is divided anew for every element below it, so n unknowns take n(n - 1)/2
// divisions and n roots, and solving two more divisions for each.
#pragma once

#include "workload/math/kernel_kinds.h"
#include "workload/math/matrix.h"
#include "workload/math/target_compiler.h"

namespace leviosim::vio::levio {

/// Replaces the lower triangle of the symmetric A by L with A = L Lᵀ. What lies above the diagonal
/// is neither read nor written.
/// @return false if A is not positive definite; its lower triangle is then partly overwritten
template <class P>
LEVIOSIM_TARGET_CALL bool cholesky_factor(MatrixView<P> a) {
  using F = typename P::F32;
  const typename P::Function function("levio_cholesky_factor");
  const typename P::OffloadRegion kernel(solve_of_size(a.rows()), factor_items(a.rows(), a.rows()));
  for (int i : P::range(0, a.rows())) {
    for (int j : P::range(0, i)) {
      F sum = a(i, j);
      for (int k : P::range(0, j)) sum -= a(i, k) * a(j, k);
      a(i, j) = F(F(1.0f) / F(a(j, j))) * sum;
    }
    F sum = a(i, i);
    for (int k : P::range(0, i)) {
      const F l = a(i, k);
      sum -= l * l;
    }
    if (!(sum > 0.0f)) return false;
    a(i, i) = work::sqrt(sum);
  }
  return true;
}

/// Solves L Lᵀ x = b for the factor of cholesky_factor; b becomes x.
template <class P>
LEVIOSIM_TARGET_CALL void cholesky_solve(ConstMatrixView<P> l,
                                         typename P::template Span<typename P::F32> b) {
  using F = typename P::F32;
  const typename P::Function function("levio_cholesky_solve");
  const int n = l.rows();
  const typename P::OffloadRegion kernel(solve_of_size(n), substitution_items(n, n));
  for (int i : P::range(0, n)) {
    F sum = b[i];
    for (int k : P::range(0, i)) sum -= l(i, k) * b[k];
    b[i] = sum / F(l(i, i));
  }
  for (int i : P::down_range(n - 1, 0)) {
    F sum = b[i];
    for (int k : P::range(i + 1, n)) sum -= l(k, i) * b[k];
    b[i] = sum / F(l(i, i));
  }
}

}  // namespace leviosim::vio::levio
