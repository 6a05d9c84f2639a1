// RANSAC for the essential matrix as the released program runs it
// (PARAMETERS.md#eight-point-algorithm): in batches of 8 the master draws the samples, one fork
// computes a hypothesis per sample, another scores them, and the master keeps the best.
//
// The number of iterations is fixed: nothing stops early, and nothing is fitted to the inliers.
#pragma once

#include "sim/work/machine.h"
#include "workload/vio/levio/geometry/eight_point.h"
#include "workload/vio/levio/geometry/sampling.h"

namespace leviosim::vio::levio {

struct EssentialRansacOptions {
  int iterations = 640;  ///< a multiple of `batch`
  int batch = 8;         ///< hypotheses per fork
};

template <class P>
struct EssentialResult {
  bool ok = false;  ///< false if no hypothesis has an inlier
  int inliers = 0;
};

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
