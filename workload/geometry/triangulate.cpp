#include "workload/geometry/triangulate.h"

#include "workload/math/inverse_power.h"
#include "workload/math/matrix.h"

namespace leviosim::vio {
namespace {

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
                            const Vec2<P>& b, work::Arena& scratch,
                            const TriangulationOptions& options) {
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
  smallest_eigenvector<P>(AtA, x, scratch, options.max_power_steps, F(options.power_tolerance));
  const F w = x[3];
  if (work::abs(w) > F(kInfinitelyFar)) {
    const F inverse_w = F(1.0f) / w;
    return {true, {x[0] * inverse_w, x[1] * inverse_w, x[2] * inverse_w}};
  }
  return {false, {0.0f, 0.0f, 0.0f}};
}

template <class P>
typename P::F32 reprojection_error_sq(const Pose<P>& T_camera_world, const Vec3<P>& point,
                                      const Vec2<P>& seen, const PinholeCamera& camera) {
  return error_sq_in_view<P>(T_camera_world * point, seen, camera);
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

template Triangulated<work::Native> triangulate(const Pose<work::Native>&,
                                                const Pose<work::Native>&,
                                                const Vec2<work::Native>&,
                                                const Vec2<work::Native>&, work::Arena&,
                                                const TriangulationOptions&);
template work::Native::F32 reprojection_error_sq(const Pose<work::Native>&,
                                                 const Vec3<work::Native>&,
                                                 const Vec2<work::Native>&, const PinholeCamera&);
template bool agrees_with_view(const Pose<work::Native>&, const Vec3<work::Native>&,
                               const Vec2<work::Native>&, const PinholeCamera&, float);
template bool agrees_with_infinity(const Pose<work::Native>&, const Pose<work::Native>&,
                                   const Vec2<work::Native>&, const Vec2<work::Native>&,
                                   const PinholeCamera&, float);

template Triangulated<work::Counting> triangulate(const Pose<work::Counting>&,
                                                  const Pose<work::Counting>&,
                                                  const Vec2<work::Counting>&,
                                                  const Vec2<work::Counting>&, work::Arena&,
                                                  const TriangulationOptions&);
template work::Counting::F32 reprojection_error_sq(const Pose<work::Counting>&,
                                                   const Vec3<work::Counting>&,
                                                   const Vec2<work::Counting>&,
                                                   const PinholeCamera&);
template bool agrees_with_view(const Pose<work::Counting>&, const Vec3<work::Counting>&,
                               const Vec2<work::Counting>&, const PinholeCamera&, float);
template bool agrees_with_infinity(const Pose<work::Counting>&, const Pose<work::Counting>&,
                                   const Vec2<work::Counting>&, const Vec2<work::Counting>&,
                                   const PinholeCamera&, float);

}  // namespace leviosim::vio
