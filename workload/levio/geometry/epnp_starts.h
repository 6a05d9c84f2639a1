// The coefficients β of EPnP's four null vectors as the released program finds them
// (PARAMETERS.md#epnp): three starts from a linear solution for some of the products of two β, and
// five Gauss-Newton steps. The control points in the camera frame are c_j = Σ_k β_k v_k,j; their
// six mutual distances are known: ρ = L ββ, with the products in the order β1β1, β1β2, β2β2, β1β3,
// β2β3, β3β3, β1β4, β2β4, β3β4, β4β4.
#pragma once

#include "sim/work/arena.h"
#include "workload/math/matrix.h"

namespace leviosim::vio::levio {

inline constexpr int kControlPoints = 4;
inline constexpr int kDistances = 6;  ///< pairs of control points
inline constexpr int kBetas = 4;
inline constexpr int kProducts = 10;
/// Products solved for: 4 (β1β1 β1β2 β1β3 β1β4), 3 (β1β1 β1β2 β2β2), 5 (those and β1β3 β2β3).
inline constexpr int kStarts = 3;
inline constexpr int kGaussNewtonSteps = 5;

template <class P>
struct DistanceSystem {
  MatrixView<P> l;                                 ///< 6×10
  typename P::template Span<typename P::F32> rho;  ///< 6, squared distances in m²
};

/// Fills the system.
/// @param null_vectors  rows of 12: row k is v_k, coordinate c of control point j at 3j + c
/// @param control_points  4×3, world frame, m
template <class P>
void fill_distance_system(const DistanceSystem<P>& system, MatrixView<P> null_vectors,
                          MatrixView<P> control_points);

/// The coefficients of a start, 0 … kStarts - 1. β1 that vanishes gives coefficients that are not
/// finite.
template <class P>
void start_betas(const DistanceSystem<P>& system, int start,
                 typename P::template Span<typename P::F32> betas, work::Arena& scratch);

/// kGaussNewtonSteps steps, each with a least-squares solution of a 6×4 Jacobian.
template <class P>
void refine_betas(const DistanceSystem<P>& system, typename P::template Span<typename P::F32> betas,
                  work::Arena& scratch);

}  // namespace leviosim::vio::levio
