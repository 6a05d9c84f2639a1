#include "workload/geometry/recover_pose.h"

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

template FourPoses<work::Native> decompose_essential(const Mat3<work::Native>&,
                                                     const RecoverPoseOptions&);
template FourPoses<work::Counting> decompose_essential(const Mat3<work::Counting>&,
                                                       const RecoverPoseOptions&);
template TwoViewPose<work::Native> recover_pose(work::Machine&, const TwoViewMatches<work::Native>&,
                                                work::Native::Span<const work::Native::Byte>,
                                                const Mat3<work::Native>&,
                                                const RecoverPoseOptions&);
template TwoViewPose<work::Counting> recover_pose(work::Machine&,
                                                  const TwoViewMatches<work::Counting>&,
                                                  work::Counting::Span<const work::Counting::Byte>,
                                                  const Mat3<work::Counting>&,
                                                  const RecoverPoseOptions&);

}  // namespace leviosim::vio
