// The 9 rows of an interval between two keyframes: rotation, velocity, position, in the order of
// ImuResidual. The last column is the residual, those before it its derivatives.
#pragma once

#include "workload/inertial/preintegration.h"
#include "workload/inertial/residual.h"
#include "workload/math/matrix.h"

namespace leviosim::vio {

/// Columns of a keyframe's unknowns, in those of the system.
inline constexpr int kPositionColumn = 3, kVelocityColumn = 6;

namespace interval {

inline constexpr int kRotationRow = 0, kVelocityRow = 3, kPositionRow = 6;
inline constexpr int kEnd = 9;  ///< first column of the keyframe at the end

template <class P>
void store_block(MatrixView<P> rows, int r, int c, const Mat3<P>& block) {
  store_mat3<P>(rows.data(), r * rows.cols() + c, block, rows.cols());
}

template <class P>
void store_residual(MatrixView<P> rows, const ImuResidual<P>& r) {
  const int column = rows.cols() - 1;
  const Vec3<P> parts[3] = {r.rotation, r.velocity, r.position};
  for (int i = 0; i < 3; ++i) {
    rows(3 * i, column) = parts[i].x;
    rows(3 * i + 1, column) = parts[i].y;
    rows(3 * i + 2, column) = parts[i].z;
  }
}

template <class P>
typename P::F32 half_square_of_residual(MatrixView<P> rows) {
  using F = typename P::F32;
  const int column = rows.cols() - 1;
  F sum = 0.0f;
  for (int r : P::range(0, 9)) {
    const F e = rows(r, column);
    sum += e * e;
  }
  return sum * F(0.5f);
}

/// Multiplies columns [begin, end) by the inverse of the Cholesky factor of the interval's
/// covariance (window.h): forward substitution.
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

}  // namespace interval
}  // namespace leviosim::vio
