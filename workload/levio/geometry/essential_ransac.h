// RANSAC for the essential matrix as the released program runs it
// (PARAMETERS.md#eight-point-algorithm): in batches of one sample for each core, or a few, the
// master draws the samples, one fork computes a hypothesis per sample, another scores them, and the
// master keeps the best.
//
// The number of iterations is fixed: nothing stops early, and nothing is fitted to the inliers.
#pragma once

#include "sim/work/machine.h"
#include "workload/levio/geometry/eight_point.h"
#include "workload/levio/geometry/sampling.h"
#include "workload/math/matrix.h"

namespace leviosim::vio::levio {

/// How well a hypothesis fits: places in local memory that are updated with every inlier.
template <class P>
struct EssentialScore {
  typename P::template Span<typename P::I32> inliers;    ///< 1
  typename P::template Span<typename P::F32> error_sum;  ///< 1, of the inliers' Sampson errors
};

/// Counts the matches whose squared Sampson error, in normalised coordinates, is below `threshold`
/// and writes 1 for them, 0 for the others, to `inlier_mask` (n elements). One division per match.
template <class P>
void score_essential(MatrixView<P> essential, const TwoViewMatches<P>& matches,
                     typename P::F32 threshold,
                     typename P::template Span<typename P::Byte> inlier_mask,
                     const EssentialScore<P>& score);

struct EssentialRansacOptions {
  int iterations = 640;
  int batch = 0;  ///< hypotheses per fork; 0: as the team has cores (sampling.h)
};

template <class P>
struct EssentialResult {
  bool ok = false;  ///< false if no hypothesis has an inlier
  int inliers = 0;
};

/// Local memory of estimate_essential() with one hypothesis for each core.
/// @param matches  the most that there can be
Bytes essential_memory(int matches, int cores);

/// Works inside a stage of `machine`.
/// @param threshold    of an inlier's squared Sampson error, in normalised coordinates
/// @param essential    3×3, the result: x_bᵀ E x_a = 0
/// @param inlier_mask  one element per match: 1 for the inliers of the result
template <class P>
EssentialResult<P> estimate_essential(work::Machine& machine, const TwoViewMatches<P>& matches,
                                      typename P::F32 threshold, ShiftRegister<P>& random,
                                      const EssentialRansacOptions& options,
                                      MatrixView<P> essential,
                                      typename P::template Span<typename P::Byte> inlier_mask);

}  // namespace leviosim::vio::levio
