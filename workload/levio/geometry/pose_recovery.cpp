#include "workload/levio/geometry/pose_recovery.h"

#include <algorithm>

#include "workload/levio/geometry/levio_inverse_power.h"
#include "workload/levio/geometry/pose_matrix.h"
#include "workload/levio/geometry/svd.h"
#include "workload/levio/geometry/two_view_point.h"

namespace leviosim::vio::levio {
namespace {

constexpr int kPoses = 4;

/// R = U W Vᵀ with the quarter turn W = [0 -1 0; 1 0 0; 0 0 1], or with its inverse; a rotation,
/// not a reflection: E is known up to its sign.
template <class P>
Mat3<P> rotation_of(MatrixView<P> u, MatrixView<P> v, bool inverse_turn, work::Arena& scratch) {
  using F = typename P::F32;
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> turn = alloc_matrix<P>(scratch, "quarter turn", 3, 3);
  const MatrixView<P> turned = alloc_matrix<P>(scratch, "U W", 3, 3);
  const MatrixView<P> rotation = alloc_matrix<P>(scratch, "U W Vt", 3, 3);
  fill<P>(turn, 0.0f);
  turn(0, 1) = inverse_turn ? 1.0f : -1.0f;
  turn(1, 0) = inverse_turn ? -1.0f : 1.0f;
  turn(2, 2) = 1.0f;
  product<P>(turned, plain<P>(u), plain<P>(turn));
  product<P>(rotation, plain<P>(turned), transposed<P>(v));
  Mat3<P> R{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) R.m[r][c] = F(rotation(r, c));
  if (determinant(R) < 0.0f)
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) R.m[r][c] = -R.m[r][c];
  return R;
}

/// The four poses T_b_a with E = ± [t]× R and |t| = 1, as rows of 16.
template <class P>
void write_poses(MatrixView<P> poses, MatrixView<P> essential, work::Arena& scratch) {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;
  const typename P::Function function("levio_decompose_essential");
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> u = alloc_matrix<P>(scratch, "U", 3, 3);
  const MatrixView<P> v = alloc_matrix<P>(scratch, "V", 3, 3);
  const Span s = scratch.alloc<Span>("singular values", 3);
  svd<P>(essential, u, s, v, scratch);
  // The third column of U is of a singular value that is zero: what rounding leaves of it.
  const Vec3<P> u0{F(u(0, 0)), F(u(1, 0)), F(u(2, 0))};
  const Vec3<P> u1{F(u(0, 1)), F(u(1, 1)), F(u(2, 1))};
  const Vec3<P> t = cross(u0, u1);
  u(0, 2) = t.x;
  u(1, 2) = t.y;
  u(2, 2) = t.z;
  const Mat3<P> R1 = rotation_of<P>(u, v, false, scratch);
  const Mat3<P> R2 = rotation_of<P>(u, v, true, scratch);
  const Pose<P> all[kPoses] = {{R1, t}, {R1, -t}, {R2, t}, {R2, -t}};
  for (int k = 0; k < kPoses; ++k) store_pose<P>(MatrixView<P>(poses.row(k), 4, 4), all[k]);
}

/// The core's slice of ceil(n / cores) items, the last ones taking what is left.
inline work::Share slice_of(int n, const work::Core& core) {
  const int each = (n + core.cores - 1) / core.cores;
  return {std::min(n, core.id * each), std::min(n, (core.id + 1) * each)};
}

/// The matches from first on, as many as points have room.
template <class P>
void triangulate_all(work::Machine& machine, MatrixView<P> T_a, MatrixView<P> T_b,
                     const PixelMatches<P>& matches, int first, const CameraConstants<P>& camera,
                     MatrixView<P> points) {
  using F = typename P::F32;
  machine.fork_aligned_on_one_core(
      "recover pose",
      [&](work::Core& core) {
        const auto [begin, end] = slice_of(points.rows(), core);
        for (int i : P::range(begin, end)) {
          const int at = 2 * (first + i);
          const Vec2<P> a{F(matches.a[at]), F(matches.a[at + 1])};
          const Vec2<P> b{F(matches.b[at]), F(matches.b[at + 1])};
          const Vec3<P> x = triangulate<P>(T_a, T_b, a, b, camera, core.scratch);
          points(i, 0) = x.x;
          points(i, 1) = x.y;
          points(i, 2) = x.z;
        }
      },
      kTriangulationScratch);
}

/// How many of the points lie in front of both cameras; the master's work.
template <class P>
typename P::I32 count_in_front(MatrixView<P> points, MatrixView<P> T_b) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const typename P::Function function("levio_count_in_front");
  PointMover<P> into_b(T_b);
  I32 in_front = 0;
  for (int i : P::range(0, points.rows())) {
    const Vec3<P> in_a{F(points(i, 0)), F(points(i, 1)), F(points(i, 2))};
    const Vec3<P> in_b = into_b(in_a);
    if (in_a.z > 0.0f && in_b.z > 0.0f) in_front += I32(1);
  }
  return in_front;
}

/// As many of the points as have room beside the scratch of the cores, and that of write_poses().
int points_at_once(const work::Machine& machine, int matches) {
  constexpr Bytes kPoint(3 * 4), kPadding(4), kOfPoses(512);
  const Bytes scratch = std::max(kOfPoses, (kTriangulationScratch + kPadding) * machine.cores());
  const Bytes room = machine.local().free() - scratch;
  return static_cast<int>(std::clamp<std::int64_t>(room.count() / kPoint.count(), 1, matches));
}

}  // namespace

template <class P>
RecoveredPose<P> recover_pose(work::Machine& machine, MatrixView<P> essential,
                              const PixelMatches<P>& matches, const CameraConstants<P>& camera) {
  using I32 = typename P::I32;
  const typename P::Function function("levio_recover_pose");
  work::Arena& local = machine.local();
  const work::Arena::Frame frame(local);
  const MatrixView<P> poses = alloc_matrix<P>(local, "poses of the essential matrix", kPoses, 16);
  const MatrixView<P> T_a = alloc_matrix<P>(local, "pose of the keyframe", 4, 4);
  const MatrixView<P> points =
      alloc_matrix<P>(local, "triangulated points", points_at_once(machine, matches.n), 3);
  write_poses<P>(poses, essential, local);
  store_pose<P>(T_a, Pose<P>::identity());
  RecoveredPose<P> best;
  I32 most_in_front = 0;
  for (int k : P::range(0, kPoses)) {
    const MatrixView<P> T_b(poses.row(k), 4, 4);
    I32 in_front = 0;
    for (int first = 0; first < matches.n; first += points.rows()) {
      const MatrixView<P> part(points.data(), std::min(points.rows(), matches.n - first), 3);
      triangulate_all<P>(machine, T_a, T_b, matches, first, camera, part);
      const I32 of_part = count_in_front<P>(part, T_b);
      in_front = first == 0 ? of_part : I32(in_front + of_part);
    }
    if (in_front > most_in_front) {
      most_in_front = in_front;
      best = {true, load_pose<P>(T_b), work::value(in_front)};
    }
  }
  return best;
}

#define LEVIOSIM_INSTANTIATE(P)                                                                 \
  template RecoveredPose<P> recover_pose(work::Machine&, MatrixView<P>, const PixelMatches<P>&, \
                                         const CameraConstants<P>&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

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
