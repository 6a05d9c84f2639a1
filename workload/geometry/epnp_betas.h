// The coefficients β of the four null vectors in EPnP. The control points in the camera frame are
// c_j = Σ_k β_k v_k,j; their six mutual distances are known: ρ = L ββ, with the ten products
// ββ = (β1β1, β1β2, β2β2, β1β3, β2β3, β3β3, β1β4, β2β4, β3β4, β4β4), and L a 6×10 matrix.
//
// Three hypotheses are started from a linear solution for some of the products, the others taken as
// zero, and refined by Gauss-Newton over all four coefficients.
#pragma once

#include "sim/work/arena.h"
#include "workload/math/matrix.h"

namespace leviosim::vio {

inline constexpr int kControlPoints = 4;
inline constexpr int kDistances = 6;  ///< pairs of control points
inline constexpr int kBetas = 4;
inline constexpr int kProducts = 10;
inline constexpr int kBetaHypotheses = 3;

/// What the hypotheses start from.
template <class P>
struct DistanceSystem {
  MatrixView<P> l;                                 ///< 6×10
  typename P::template Span<typename P::F32> rho;  ///< 6, squared distances in m²
};

/// Fills the system from the null vectors and the control points in the world frame.
/// @param null_vectors  12×4: column k is v_k, with coordinate c of control point j in row 3j + c
/// @param control_points  4×3, m
template <class P>
void fill_distance_system(const DistanceSystem<P>& system, MatrixView<P> null_vectors,
                          MatrixView<P> control_points);

/// Writes the coefficients of hypothesis 0, 1 or 2 (N = 1, 2, 3) to `betas` (4).
/// @return false if the linear system is singular
template <class P>
bool initial_betas(const DistanceSystem<P>& system, int hypothesis,
                   typename P::template Span<typename P::F32> betas, work::Arena& scratch);

/// Refines `betas` by `steps` Gauss-Newton steps, each a Householder QR of a 6×4 Jacobian; stops
/// early if one is singular.
template <class P>
void refine_betas(const DistanceSystem<P>& system, typename P::template Span<typename P::F32> betas,
                  int steps, work::Arena& scratch);

}  // namespace leviosim::vio
