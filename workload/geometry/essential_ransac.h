// RANSAC for the essential matrix of two views (paper section III, "8-point RANSAC"; iterations,
// threshold and the parallel form from PARAMETERS.md#eight-point-algorithm).
//
// In batches of 8: the master draws the samples, the team computes one hypothesis per sample, the
// team scores them over all matches, the master keeps the best. The number of iterations is fixed:
// there is no early exit on a high share of inliers, and no refit to the inliers at the end.
#pragma once

#include <cstdint>

#include "sim/work/arena.h"
#include "sim/work/machine.h"
#include "workload/math/jacobi.h"
#include "workload/math/vec.h"

namespace leviosim::vio {

// The 8-point algorithm for the essential matrix (paper section III, "8-point RANSAC"; order of
// operations from PARAMETERS.md#eight-point-algorithm), and the Sampson error that scores it.
//
// Convention: x_bᵀ E x_a = 0 for a point seen at x_a by camera a (the reference, the previous
// keyframe) and at x_b by camera b (the current frame), so E = [t]× R with T_b_a = (R, t).
//
// The facts do not state the tolerance of the inverse power iteration; it is assumed to be that of
// the Jacobi iterations. It decides the work: at 1e-8 one sample in three takes all 15 steps, at
// 1e-6 one in a hundred, while the accuracy is the same.
//
// Left out: equal singular values of E, which a rank of 2 does not imply (decomposing E into a pose
// ignores them; scoring is a little better without), and Hartley's normalisation of the sample;
// coordinates are normalised by the camera only.

/// Points seen by two cameras, in normalised image coordinates: match i at a[2i], a[2i+1] and
/// b[2i], b[2i+1].
template <class P>
struct TwoViewMatches {
  typename P::template Span<const typename P::F32> a, b;
  int n;

  Vec2<P> in_a(int i) const { return {a[2 * i], a[2 * i + 1]}; }
  Vec2<P> in_b(int i) const { return {b[2 * i], b[2 * i + 1]}; }
};

struct EightPointOptions {
  int max_power_steps = 15;       ///< of the inverse power iteration for the null vector of H
  float power_tolerance = 1e-8f;  ///< it stops when no component of the unit vector changes by more
  int max_svd_rotations = 10;     ///< of the Jacobi SVD that projects to rank 2
  DiagonalPrecision svd_precision = DiagonalPrecision::Double;
};

/// The matrix E of rank 2 and norm 1 or less that fits the matches listed in `sample` (at least 8)
/// in the least-squares sense.
///
/// A degenerate sample gives some matrix, which need not fit the other matches. Takes 756 bytes of
/// scratch (for 8 matches) during the call.
template <class P>
Mat3<P> essential_from_sample(const TwoViewMatches<P>& matches,
                              typename P::template Span<const typename P::U16> sample,
                              const EightPointOptions& options, work::Arena& scratch);

/// Counts the matches whose squared Sampson error, in normalised coordinates, is below `threshold`
/// and writes 1 for them, 0 for the others, to `inlier_mask` (n elements). One division per match.
template <class P>
typename P::I32 score_essential(const Mat3<P>& E, const TwoViewMatches<P>& matches,
                                typename P::F32 threshold,
                                typename P::template Span<typename P::Byte> inlier_mask);

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

struct EssentialOptions {
  int iterations = 640;
  int sample = 8;          ///< matches per hypothesis, at least 8
  int batch = 8;           ///< hypotheses between two decisions of the master
  float inlier_px = 0.7f;  ///< Sampson error of an inlier
  EightPointOptions solver;
  std::uint32_t seed = 1;
};

template <class P>
struct EssentialResult {
  bool ok;    ///< false with fewer matches than a sample, or fewer inliers than a sample
  Mat3<P> E;  ///< x_bᵀ E x_a = 0, of rank 2; zero if not ok
  int inliers;
};

/// @param fx           focal length in px, which turns the threshold into normalised coordinates
/// @param inlier_mask  one element per match: 1 for the inliers of E, 0 for the others
template <class P>
EssentialResult<P> estimate_essential(work::Machine& machine, const TwoViewMatches<P>& matches,
                                      float fx, const EssentialOptions& options,
                                      typename P::template Span<typename P::Byte> inlier_mask);

}  // namespace leviosim::vio
