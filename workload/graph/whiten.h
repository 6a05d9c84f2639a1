// Whitening of an interval's residual and its derivatives: rows are multiplied by the inverse of
// the Cholesky factor of the interval's covariance (window.h).
#pragma once

#include "workload/inertial/preintegration.h"

namespace leviosim::vio {

/// Multiplies columns [begin, end) by the inverse of the factor: forward substitution.
template <class P>
void whiten(const Preintegration<P>& interval, MatrixView<P> rows, int begin, int end) {
  using F = typename P::F32;
  const typename P::Function function("whiten");
  const MatrixView<P> factor = interval.covariance();
  for (int r : P::range(0, 9)) {
    const F inverse_diagonal = factor(r, r);
    for (int c : P::range(begin, end)) {
      F sum = rows(r, c);
      for (int k : P::range(0, r)) sum -= factor(r, k) * rows(k, c);
      rows(r, c) = sum * inverse_diagonal;
    }
  }
}

}  // namespace leviosim::vio
