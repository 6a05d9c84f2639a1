// The essential matrix of eight matches as the released program computes it
// (PARAMETERS.md#eight-point-algorithm), and the Sampson error that scores it. Nothing is checked
// on the way; a degenerate sample gives some matrix, or one that is not a number.
//
// Convention: x_bᵀ E x_a = 0 for a point seen at x_a by camera a (the last keyframe) and at x_b by
// camera b (the current frame).
#pragma once

#include "sim/work/arena.h"
#include "workload/math/matrix.h"
#include "workload/math/vec.h"

namespace leviosim::vio::levio {

inline constexpr int kEssentialSample = 8;  ///< matches

/// Points seen by two cameras, in normalised image coordinates: match i at a[2i], a[2i+1] and
/// b[2i], b[2i+1].
template <class P>
struct TwoViewMatches {
  typename P::template EitherSpan<const typename P::F32> a, b;
  int n;

  Vec2<P> in_a(int i) const { return {a[2 * i], a[2 * i + 1]}; }
  Vec2<P> in_b(int i) const { return {b[2 * i], b[2 * i + 1]}; }
};

/// Scratch of one hypothesis, in whole words.
inline constexpr Bytes kEssentialScratch{668};

/// The matrix of rank 2 with two equal singular values that fits the sample. Takes
/// kEssentialScratch during the call.
/// @param essential  3×3, the result
/// @return the steps that the inverse power iteration took
template <class P>
int essential_from_sample(const TwoViewMatches<P>& matches,
                          typename P::template Span<const typename P::U16> sample,
                          MatrixView<P> essential, work::Arena& scratch);

/// The squared Sampson error of one match: its squared distance, to first order, from the nearest
/// match that satisfies E exactly.
template <class P>
typename P::F32 sampson_error_sq(const Mat3<P>& E, const Vec2<P>& a, const Vec2<P>& b) {
  using F = typename P::F32;
  const auto& e = E.m;
  const F line_b_x = e[0][0] * a.x + e[0][1] * a.y + e[0][2];
  const F line_b_y = e[1][0] * a.x + e[1][1] * a.y + e[1][2];
  const F line_b_z = e[2][0] * a.x + e[2][1] * a.y + e[2][2];
  const F line_a_x = e[0][0] * b.x + e[1][0] * b.y + e[2][0];
  const F line_a_y = e[0][1] * b.x + e[1][1] * b.y + e[2][1];
  const F residual = b.x * line_b_x + b.y * line_b_y + line_b_z;
  const F gradient_sq =
      line_b_x * line_b_x + line_b_y * line_b_y + line_a_x * line_a_x + line_a_y * line_a_y;
  return F(residual * residual) / gradient_sq;
}

}  // namespace leviosim::vio::levio
