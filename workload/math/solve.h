// Systems of linear equations in memory: Gaussian elimination, Cholesky.
// All work in place; the sizes are those of the views.
//
// Left out: blocking and iterative refinement; systems have at most some tens of unknowns.
#pragma once

#include "workload/math/kernel_kinds.h"
#include "workload/math/matrix.h"
#include "workload/math/vec.h"

namespace leviosim::vio {

namespace solve {

/// Row of the largest |a(r, k)|, r ≥ k, and that magnitude.
template <class P>
struct Pivot {
  typename P::I32 row;
  typename P::F32 magnitude;
};

template <class P>
Pivot<P> find_pivot(MatrixView<P> a, int k) {
  using F = typename P::F32;
  Pivot<P> pivot{k, work::abs(F(a(k, k)))};
  for (int r : P::range(k + 1, a.rows())) {
    const F magnitude = work::abs(F(a(r, k)));
    if (magnitude > pivot.magnitude) pivot = {r, magnitude};
  }
  return pivot;
}

template <class P>
void swap_rows(MatrixView<P> a, typename P::template Span<typename P::F32> b, int k,
               typename P::I32 other_row) {
  using F = typename P::F32;
  const auto row = a.row(k);
  const auto other = a.row(other_row);
  for (int c : P::range(k, a.cols())) {
    const F moved = row[c];
    row[c] = F(other[c]);
    other[c] = moved;
  }
  const F moved = b[k];
  b[k] = F(b[other_row]);
  b[other_row] = moved;
}

/// x from the upper triangle of a: a x = b.
template <class P>
void back_substitute(MatrixView<P> a, typename P::template Span<typename P::F32> b,
                     typename P::template Span<typename P::F32> x) {
  using F = typename P::F32;
  const int n = a.cols();
  for (int r : P::down_range(n - 1, 0)) {
    F sum = b[r];
    for (int c : P::range(r + 1, n)) sum -= a(r, c) * x[c];
    x[r] = sum / a(r, r);
  }
}

}  // namespace solve

/// Solves A x = b by Gaussian elimination with partial pivoting.
/// @param a  n×n, destroyed
/// @param b  n, destroyed
/// @param smallest_pivot  pivots that are not larger in magnitude are replaced by it, as the
/// inverse
///   power method needs for singular matrices; with 0, a zero pivot ends the work
/// @return false if the matrix is singular (or not finite); x is then undefined
template <class P>
bool solve_gauss(MatrixView<P> a, typename P::template Span<typename P::F32> b,
                 typename P::template Span<typename P::F32> x,
                 typename P::F32 smallest_pivot = 0.0f) {
  using F = typename P::F32;
  const typename P::Function function("solve_gauss");
  const int n = a.rows();
  const typename P::OffloadRegion kernel(solve_of_size(n),
                                         factor_items(n, n) + substitution_items(n, n));
  for (int k : P::range(0, n)) {
    const solve::Pivot<P> pivot = solve::find_pivot<P>(a, k);
    if (pivot.magnitude > smallest_pivot) {
      if (pivot.row != k) solve::swap_rows<P>(a, b, k, pivot.row);
    } else {
      if (smallest_pivot == 0.0f) return false;
      a(k, k) = smallest_pivot;
    }
    const F inverse = F(1.0f) / a(k, k);
    const F bk = b[k];
    for (int r : P::range(k + 1, n)) {
      const F factor = a(r, k) * inverse;
      for (int c : P::range(k + 1, n)) a(r, c) -= factor * a(k, c);
      b[r] -= factor * bk;
    }
  }
  solve::back_substitute<P>(a, b, x);
  return true;
}

/// Replaces the lower triangle of the symmetric A by L with A = L Lᵀ. The diagonal of L is stored
/// *inverted*, so that solving needs no division. The strict upper triangle is neither read nor
/// written.
/// @return false if A is not positive definite; its lower triangle is then partly overwritten
template <class P>
bool cholesky_factor(MatrixView<P> a) {
  using F = typename P::F32;
  const typename P::Function function("cholesky_factor");
  const typename P::OffloadRegion kernel(solve_of_size(a.rows()), factor_items(a.rows(), a.rows()));
  for (int i : P::range(0, a.rows())) {
    for (int j : P::range(0, i)) {
      F sum = a(i, j);
      for (int k : P::range(0, j)) sum -= a(i, k) * a(j, k);
      a(i, j) = sum * F(a(j, j));
    }
    F sum = a(i, i);
    for (int k : P::range(0, i)) {
      const F l = a(i, k);
      sum -= l * l;
    }
    if (!(sum > 0.0f)) return false;
    a(i, i) = F(1.0f) / work::sqrt(sum);
  }
  return true;
}

/// Solves L x = b for the factor of cholesky_factor; b becomes x.
template <class P>
void forward_substitute(ConstMatrixView<P> l, typename P::template Span<typename P::F32> b) {
  using F = typename P::F32;
  for (int i : P::range(0, l.rows())) {
    F sum = b[i];
    for (int k : P::range(0, i)) sum -= l(i, k) * b[k];
    b[i] = sum * F(l(i, i));
  }
}

/// Solves Lᵀ x = b for the factor of cholesky_factor; b becomes x.
template <class P>
void back_substitute(ConstMatrixView<P> l, typename P::template Span<typename P::F32> b) {
  using F = typename P::F32;
  const int n = l.rows();
  for (int i : P::down_range(n - 1, 0)) {
    F sum = b[i];
    for (int k : P::range(i + 1, n)) sum -= l(k, i) * b[k];
    b[i] = sum * F(l(i, i));
  }
}

/// xᵀ A⁻¹ x = |L⁻¹ x|², for the factor L of A by cholesky_factor: of an information matrix, the
/// variance of a linear function of the unknowns. Overwrites x.
template <class P>
typename P::F32 square_by_inverse(ConstMatrixView<P> l,
                                  typename P::template Span<typename P::F32> x) {
  using F = typename P::F32;
  forward_substitute<P>(l, x);
  F square = 0.0f;
  for (int i : P::range(0, l.rows())) square += F(x[i]) * F(x[i]);
  return square;
}

/// Solves L Lᵀ x = b for the factor of cholesky_factor; b becomes x.
template <class P>
void cholesky_solve(ConstMatrixView<P> l, typename P::template Span<typename P::F32> b) {
  const typename P::Function function("cholesky_solve");
  const int n = l.rows();
  const typename P::OffloadRegion kernel(solve_of_size(n), substitution_items(n, n));
  forward_substitute<P>(l, b);
  back_substitute<P>(l, b);
}

/// Inverse of a symmetric positive definite 3×3 matrix (a landmark block), by cofactors.
/// @return false if a leading minor is not positive; `inverse` is then untouched
template <class P>
bool invert_spd3(const Mat3<P>& a, Mat3<P>& inverse) {
  using F = typename P::F32;
  const F axx = a.m[0][0], axy = a.m[0][1], axz = a.m[0][2];
  const F ayy = a.m[1][1], ayz = a.m[1][2], azz = a.m[2][2];
  const F xx = ayy * azz - ayz * ayz;
  const F xy = axz * ayz - axy * azz;
  const F xz = axy * ayz - axz * ayy;
  const F zz = axx * ayy - axy * axy;
  const F determinant = axx * xx + axy * xy + axz * xz;
  if (!(axx > 0.0f) || !(zz > 0.0f) || !(determinant > 0.0f)) return false;
  const F scale = F(1.0f) / determinant;
  const F yy = axx * azz - axz * axz;
  const F yz = axy * axz - axx * ayz;
  const F ixy = xy * scale, ixz = xz * scale, iyz = yz * scale;
  inverse = {{{xx * scale, ixy, ixz}, {ixy, yy * scale, iyz}, {ixz, iyz, zz * scale}}};
  return true;
}

}  // namespace leviosim::vio
