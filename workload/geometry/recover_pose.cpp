#include "workload/geometry/recover_pose.h"

#include "workload/math/inverse_power.h"
#include "workload/math/matrix.h"
#include "workload/math/svd.h"

namespace leviosim::vio {
namespace {

/// Whether a match triangulates to a point in front of both cameras.
template <class P>
bool in_front_of_both(const TwoViewMatches<P>& matches, int i, const Pose<P>& T_b_a,
                      work::Arena& scratch, const TriangulationOptions& options) {
  const typename P::F32 zero = 0.0f;
  const Triangulated<P> seen = triangulate<P>(Pose<P>::identity(), T_b_a, matches.in_a(i),
                                              matches.in_b(i), scratch, options);
  if (!seen.valid) return false;
  return seen.point.z > zero && (T_b_a * seen.point).z > zero;
}

/// A core's part of the triangulation: how many matches of its share lie in front.
template <class P>
typename P::I32 count_in_front(const TwoViewMatches<P>& matches,
                               typename P::template Span<const typename P::Byte> mask,
                               const Pose<P>& T_b_a, work::Core& core,
                               const TriangulationOptions& options) {
  using I32 = typename P::I32;
  const auto [begin, end] = core.share(matches.n);
  const bool use_all = mask.size() == 0;
  I32 in_front = 0;
  for (int i : P::range(begin, end)) {
    if (!use_all) {
      const I32 inlier = mask[i];
      if (inlier == I32(0)) continue;
    }
    if (in_front_of_both<P>(matches, i, T_b_a, core.scratch, options)) in_front += I32(1);
  }
  return in_front;
}

}  // namespace

template <class P>
FourPoses<P> decompose_essential(const Mat3<P>& E, const RecoverPoseOptions& options) {
  using F = typename P::F32;
  const typename P::Function function("decompose_essential");
  Mat3<P> U, V;
  Vec3<P> singular_values;
  svd3<P>(E, U, singular_values, V, options.max_svd_rotations, F(kSvdTolerance),
          options.svd_precision);
  const Vec3<P> t = U.column(2);
  // U W Vᵀ and U Wᵀ Vᵀ with the quarter turn W = [0 -1 0; 1 0 0; 0 0 1].
  Mat3<P> R1, R2;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      const F turned = U.m[r][1] * V.m[c][0] - U.m[r][0] * V.m[c][1];
      const F axis = U.m[r][2] * V.m[c][2];
      R1.m[r][c] = axis + turned;
      R2.m[r][c] = axis - turned;
    }
  // Rotations, not reflections: E is known up to its sign.
  const F handedness = determinant(U) * determinant(V);
  if (handedness < F(0.0f))
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        R1.m[r][c] = -R1.m[r][c];
        R2.m[r][c] = -R2.m[r][c];
      }
  return {{{R1, t}, {R1, -t}, {R2, t}, {R2, -t}}};
}

template <class P>
TwoViewPose<P> recover_pose(work::Machine& machine, const TwoViewMatches<P>& matches,
                            typename P::template Span<const typename P::Byte> mask,
                            const Mat3<P>& E, const RecoverPoseOptions& options) {
  using I32 = typename P::I32;
  const typename P::Function function("recover_pose");
  const FourPoses<P> poses = decompose_essential<P>(E, options);

  work::Arena& local = machine.local();
  const work::Arena::Frame frame(local);
  const auto partial =
      local.alloc<typename P::template Span<I32>>("points in front", machine.cores());
  TwoViewPose<P> best{false, Pose<P>::identity(), 0};
  I32 most_in_front = 0;
  for (const Pose<P>& T_b_a : poses.T_b_a) {
    machine.fork("recover pose", [&](work::Core& core) {
      partial[core.id] = count_in_front<P>(matches, mask, T_b_a, core, options.triangulation);
    });
    I32 in_front = 0;
    for (int core : P::range(0, machine.cores())) in_front += I32(partial[core]);
    if (in_front > most_in_front) {
      most_in_front = in_front;
      best = {true, T_b_a, work::value(in_front)};
    }
  }
  return best;
}

#define LEVIOSIM_INSTANTIATE(P)                                                         \
  template FourPoses<P> decompose_essential(const Mat3<P>&, const RecoverPoseOptions&); \
  template TwoViewPose<P> recover_pose(work::Machine&, const TwoViewMatches<P>&,        \
                                       P::Span<const P::Byte>, const Mat3<P>&,          \
                                       const RecoverPoseOptions&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

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

#define LEVIOSIM_INSTANTIATE(P)                                                                    \
  template Triangulated<P> triangulate(const Pose<P>&, const Pose<P>&, const Vec2<P>&,             \
                                       const Vec2<P>&, work::Arena&, const TriangulationOptions&); \
  template P::F32 reprojection_error_sq(const Pose<P>&, const Vec3<P>&, const Vec2<P>&,            \
                                        const PinholeCamera&);                                     \
  template bool agrees_with_view(const Pose<P>&, const Vec3<P>&, const Vec2<P>&,                   \
                                 const PinholeCamera&, float);                                     \
  template bool agrees_with_infinity(const Pose<P>&, const Pose<P>&, const Vec2<P>&,               \
                                     const Vec2<P>&, const PinholeCamera&, float);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
