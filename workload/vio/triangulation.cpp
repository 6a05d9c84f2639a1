#include "workload/vio/triangulation.h"

#include "workload/math/inverse_power.h"
#include "workload/math/matrix.h"

namespace leviosim::vio {
namespace {

constexpr int kMostSteps = 15;  ///< of the inverse power iteration
/// No tolerance is stated; it is assumed to be that of the Jacobi iterations.
constexpr float kTolerance = 1e-8f;
/// Below this share of the unit eigenvector, the homogeneous coordinate is rounding noise.
constexpr float kInfinitelyFar = 1e-6f;

/// The two rows x p₃ - p₁ and y p₃ - p₂ of the projection p = [R t] of one view.
template <class P>
void write_view(MatrixView<P> A, int first_row, const Pose<P>& T, const Vec2<P>& seen) {
  const auto& R = T.R.m;
  for (int c = 0; c < 3; ++c) {
    A(first_row, c) = seen.x * R[2][c] - R[0][c];
    A(first_row + 1, c) = seen.y * R[2][c] - R[1][c];
  }
  A(first_row, 3) = seen.x * T.t.z - T.t.x;
  A(first_row + 1, 3) = seen.y * T.t.z - T.t.y;
}

template <class P>
typename P::F32 error_sq_in_view(const Vec3<P>& in_camera, const Vec2<P>& seen,
                                 const PinholeCamera& camera) {
  using F = typename P::F32;
  const F inverse_depth = F(1.0f) / in_camera.z;
  const F du = F(in_camera.x * inverse_depth - seen.x) * F(camera.fx);
  const F dv = F(in_camera.y * inverse_depth - seen.y) * F(camera.fy);
  return du * du + dv * dv;
}

}  // namespace

template <class P>
Triangulated<P> triangulate(const Pose<P>& T_a_world, const Pose<P>& T_b_world, const Vec2<P>& a,
                            const Vec2<P>& b, work::Arena& scratch) {
  using F = typename P::F32;
  const typename P::Function function("triangulate");
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> AtA = alloc_matrix<P>(scratch, "triangulation AᵀA", 4, 4);
  {
    const work::Arena::Frame rows(scratch);
    const MatrixView<P> A = alloc_matrix<P>(scratch, "triangulation A", 4, 4);
    write_view<P>(A, 0, T_a_world, a);
    write_view<P>(A, 2, T_b_world, b);
    multiply_transposed<P>(AtA, A, A);
  }
  const auto x = scratch.alloc<typename P::template Span<F>>("homogeneous point", 4);
  smallest_eigenvector<P>(AtA, x, scratch, kMostSteps, F(kTolerance));
  const F w = x[3];
  if (work::abs(w) > F(kInfinitelyFar)) {
    const F inverse_w = F(1.0f) / w;
    return {true, {x[0] * inverse_w, x[1] * inverse_w, x[2] * inverse_w}};
  }
  return {false, {0.0f, 0.0f, 0.0f}};
}

template <class P>
bool agrees_with_view(const Pose<P>& T_camera_world, const Vec3<P>& point, const Vec2<P>& seen,
                      const PinholeCamera& camera, float max_error_sq) {
  using F = typename P::F32;
  const Vec3<P> in_camera = T_camera_world * point;
  return in_camera.z > F(0.0f) && error_sq_in_view<P>(in_camera, seen, camera) < F(max_error_sq);
}

template <class P>
bool agrees_with_infinity(const Pose<P>& T_a_world, const Pose<P>& T_b_world, const Vec2<P>& a,
                          const Vec2<P>& b, const PinholeCamera& camera, float max_error_sq) {
  using F = typename P::F32;
  const Vec3<P> ray = T_b_world.R * (transpose(T_a_world.R) * Vec3<P>{a.x, a.y, 1.0f});
  return ray.z > F(0.0f) && error_sq_in_view<P>(ray, b, camera) < F(max_error_sq);
}

#define LEVIOSIM_INSTANTIATE(P)                                                        \
  template Triangulated<P> triangulate(const Pose<P>&, const Pose<P>&, const Vec2<P>&, \
                                       const Vec2<P>&, work::Arena&);                  \
  template bool agrees_with_view(const Pose<P>&, const Vec3<P>&, const Vec2<P>&,       \
                                 const PinholeCamera&, float);                         \
  template bool agrees_with_infinity(const Pose<P>&, const Pose<P>&, const Vec2<P>&,   \
                                     const Vec2<P>&, const PinholeCamera&, float);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
