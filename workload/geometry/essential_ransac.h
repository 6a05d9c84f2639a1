// RANSAC for the essential matrix of two views (paper section III, "8-point RANSAC"; iterations,
// threshold and the parallel form from PARAMETERS.md#eight-point-algorithm).
//
// In batches of 8: the master draws the samples, the team computes one hypothesis per sample, the
// team scores them over all matches, the master keeps the best. The number of iterations is fixed:
// there is no early exit on a high share of inliers, and no refit to the inliers at the end.
#pragma once

#include <cstdint>

#include "sim/work/machine.h"
#include "workload/geometry/eight_point.h"

namespace leviosim::vio {

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
