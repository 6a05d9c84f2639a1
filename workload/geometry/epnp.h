// EPnP: the pose of a camera from n ≥ 4 matches of points and pixels, without iteration over the
// pose (V. Lepetit, F. Moreno-Noguer, P. Fua, "EPnP: an accurate O(n) solution to the PnP problem",
// IJCV 2009; named by the paper, section III).
//
// World points are weighted sums of four control points; the control points in the camera frame lie
// in the null space of a matrix M of the measurements; the coefficients β of the null vectors
// follow from the known distances between the control points.
//
// Order of operations and numbers: PARAMETERS.md#epnp. In particular the null
// space comes from the *square* of MᵀM, whose condition in single precision limits the accuracy.
#pragma once

#include <cstdint>

#include "sim/work/arena.h"
#include "workload/math/jacobi.h"
#include "workload/math/vec.h"

namespace leviosim::vio {

struct PnpOptions {
  int iterations = 64;  ///< of RANSAC; a multiple of `batch`
  int sample = 4;       ///< matches per hypothesis
  int batch = 8;        ///< hypotheses per fork
  float inlier_px = 1.41421356f;
  int jacobi_max_rotations = 120;
  float jacobi_tolerance = 1e-8f;
  int gauss_newton_steps = 5;
  std::uint32_t seed = 0x2545f491u;
  DiagonalPrecision diagonal = DiagonalPrecision::Double;
  bool square_normal_matrix = true;  ///< null space of (MᵀM)² instead of MᵀM
};

/// Matches of world points and pixels.
template <class P>
struct PnpInput {
  typename P::template Span<const typename P::F32> points;  ///< 3 per match, world frame, m
  typename P::template Span<const typename P::F32> pixels;  ///< 2 per match: u, v in px
  int n = 0;
  PinholeCamera camera{};
};

template <class P>
struct EpnpSolution {
  bool valid = false;  ///< false for degenerate samples, for example collinear points
  Pose<P> T_camera_world{};
  typename P::F32 mean_error_px = 0.0f;  ///< over the sample
};

/// Solves for the matches listed in `sample` (at least 4). Needs about 3 kB of scratch for 4, freed
/// on return. Never returns a valid pose that is not finite.
template <class P>
EpnpSolution<P> solve_epnp(const PnpInput<P>& input,
                           typename P::template Span<const typename P::U16> sample,
                           const PnpOptions& options, work::Arena& scratch);

}  // namespace leviosim::vio
