#include "workload/vio/levio/geometry/triangulation.h"

#include "workload/vio/levio/algebra/inverse_power.h"
#include "workload/vio/levio/geometry/pose_matrix.h"

namespace leviosim::vio::levio {
namespace {

/// The two rows x p₃ − p₁ and y p₃ − p₂ of the projection of one view.
template <class P>
void write_view(MatrixView<P> A, int first_row, ConstMatrixView<P> T, const Vec2<P>& seen) {
  using F = typename P::F32;
  for (int c : P::range(0, 4)) {
    const F depth = T(2, c);
    A(first_row, c) = seen.x * depth - T(0, c);
    A(first_row + 1, c) = seen.y * depth - T(1, c);
  }
}

}  // namespace

template <class P>
Vec3<P> triangulate(ConstMatrixView<P> T_a, ConstMatrixView<P> T_b, const Vec2<P>& a,
                    const Vec2<P>& b, const CameraConstants<P>& camera, work::Arena& scratch) {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;
  const typename P::Function function("levio_triangulate");
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> A = alloc_matrix<P>(scratch, "triangulation A", 4, 4);
  const MatrixView<P> AtA = alloc_matrix<P>(scratch, "triangulation AtA", 4, 4);
  const Span x = scratch.alloc<Span>("homogeneous point", 4);
  write_view<P>(A, 0, T_a, camera.normalised(a.x, a.y));
  write_view<P>(A, 2, T_b, camera.normalised(b.x, b.y));
  product<P>(AtA, transposed<P>(A), plain<P>(A));
  smallest_eigenvector<P>(AtA, x);
  const F w = x[3];
  return {F(x[0]) / w, F(x[1]) / w, F(x[2]) / w};
}

template <class P>
typename P::F32 reprojection_error_sq(ConstMatrixView<P> T_camera_world, const Vec3<P>& point,
                                      const Vec2<P>& seen, const CameraConstants<P>& camera) {
  using F = typename P::F32;
  const typename P::Function function("levio_reprojection_error");
  const Vec3<P> x = PointMover<P>(T_camera_world)(point);
  const F du = camera.fx() * F(x.x / x.z) + camera.cx() - seen.x;
  const F dv = camera.fy() * F(x.y / x.z) + camera.cy() - seen.y;
  return du * du + dv * dv;
}

#define LEVIOSIM_INSTANTIATE(P)                                                             \
  template Vec3<P> triangulate(ConstMatrixView<P>, ConstMatrixView<P>, const Vec2<P>&,      \
                               const Vec2<P>&, const CameraConstants<P>&, work::Arena&);    \
  template P::F32 reprojection_error_sq(ConstMatrixView<P>, const Vec3<P>&, const Vec2<P>&, \
                                        const CameraConstants<P>&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio::levio
