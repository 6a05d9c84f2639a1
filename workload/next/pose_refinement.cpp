#include "workload/next/pose_refinement.h"

#include "workload/inertial/record.h"
#include "workload/math/rotations.h"
#include "workload/math/solve.h"

namespace leviosim::vio {
namespace {

using levio::LandmarkMatches;

constexpr int kPoseUnknowns = 6;
/// Lower triangle of H row by row, then b.
constexpr int kRightHandSide = 21;
constexpr int kSums = 27;

template <class P>
Vec3<P> point_of(const LandmarkMatches<P>& matches, int i) {
  using F = typename P::F32;
  return {F(matches.points[3 * i]), F(matches.points[3 * i + 1]), F(matches.points[3 * i + 2])};
}

/// A row of the Jacobian times the root of its weight.
template <class P>
void add_row(const typename P::F32 (&row)[kPoseUnknowns], typename P::F32 error,
             typename P::F32 weight, typename P::template Span<typename P::F32> sums) {
  using F = typename P::F32;
  int at = 0;
  for (int r = 0; r < kPoseUnknowns; ++r) {
    const F weighted = row[r] * weight;
    for (int c = 0; c <= r; ++c) sums[at++] += weighted * row[c];
    sums[kRightHandSide + r] -= weighted * error;
  }
}

template <class P>
void add_match(const LandmarkMatches<P>& matches, const PinholeCamera& camera, const Pose<P>& T,
               const RefinementOptions& options, int i,
               typename P::template Span<typename P::F32> sums) {
  using F = typename P::F32;
  const typename P::Code code("refine_pose_add_match");
  const Vec3<P> x = T * point_of<P>(matches, i);
  if (!(x.z > F(options.min_depth))) return;
  const F inverse = F(1.0f) / x.z;
  const F a = x.x * inverse, b = x.y * inverse;
  const F fx = camera.fx, fy = camera.fy;
  const F du = fx * a + F(camera.cx) - F(matches.pixels[2 * i]);
  const F dv = fy * b + F(camera.cy) - F(matches.pixels[2 * i + 1]);
  const F error_sq = du * du + dv * dv;
  F weight = 1.0f / (options.sigma_px * options.sigma_px);
  if (error_sq > F(options.huber_px * options.huber_px))
    weight *= F(options.huber_px) / work::sqrt(error_sq);
  // d(u)/dx = fx/z (1, 0, −a); times φ × x and ρ.
  const F su = fx * inverse, sv = fy * inverse, ab = a * b;
  const F of_u[kPoseUnknowns] = {-(fx * ab), fx + fx * a * a, -(fx * b), su, 0.0f, -(su * a)};
  const F of_v[kPoseUnknowns] = {-(fy + fy * b * b), fy * ab, fy * a, 0.0f, sv, -(sv * b)};
  add_row<P>(of_u, du, weight, sums);
  add_row<P>(of_v, dv, weight, sums);
}

/// The prior at T: information of each unknown, and minus its product with the difference.
template <class P>
void add_prior(const Pose<P>& T, const Pose<P>& T_predicted, const RefinementOptions& options,
               MatrixView<P> H, typename P::template Span<typename P::F32> b) {
  using F = typename P::F32;
  const Mat3<P> turn = T.R * transpose(T_predicted.R);
  const Vec3<P> rotation = so3_log<P>(turn), position = T.t - turn * T_predicted.t;
  const F of_rotation = 1.0f / (options.rotation * options.rotation);
  const F of_position = 1.0f / (options.position * options.position);
  for (int i = 0; i < 3; ++i) {
    H(i, i) += of_rotation;
    H(3 + i, 3 + i) += of_position;
  }
  store_vec3<P>(b, 0, load_vec3<P>(b, 0) - rotation * of_rotation);
  store_vec3<P>(b, 3, load_vec3<P>(b, 3) - position * of_position);
}

/// Adds up what the cores have summed.
template <class P>
void gather(MatrixView<P> partial, MatrixView<P> H, typename P::template Span<typename P::F32> b) {
  using F = typename P::F32;
  int at = 0;
  for (int r : P::range(0, kPoseUnknowns)) {
    for (int c : P::range(0, r + 1)) {
      F sum = 0.0f;
      for (int core : P::range(0, partial.rows())) sum += partial(core, at);
      H(r, c) = sum;
      ++at;
    }
    F sum = 0.0f;
    for (int core : P::range(0, partial.rows())) sum += partial(core, kRightHandSide + r);
    b[r] = sum;
  }
}

template <class P>
typename P::I32 mark_inliers(const LandmarkMatches<P>& matches, const PinholeCamera& camera,
                             const Pose<P>& T, const RefinementOptions& options, work::Share share,
                             typename P::template Span<typename P::Byte> inliers) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const float limit = options.inlier_px * options.inlier_px;
  I32 number = 0;
  for (int i : P::range(share.begin, share.end)) {
    const Vec3<P> x = T * point_of<P>(matches, i);
    const F inverse = F(1.0f) / x.z;
    const F du = F(camera.fx) * (x.x * inverse) + F(camera.cx) - F(matches.pixels[2 * i]);
    const F dv = F(camera.fy) * (x.y * inverse) + F(camera.cy) - F(matches.pixels[2 * i + 1]);
    const F error_sq = du * du + dv * dv;
    const bool agrees = x.z > F(options.min_depth) && error_sq < F(limit);
    inliers[i] = work::narrow<typename P::Byte>(I32(agrees ? 1 : 0));
    if (agrees) ++number;
  }
  return number;
}

}  // namespace

template <class P>
RefinedPose<P> refine_pose(work::Machine& machine, const LandmarkMatches<P>& matches,
                           const PinholeCamera& camera, const Pose<P>& T_predicted,
                           const RefinementOptions& options,
                           typename P::template Span<typename P::Byte> inliers) {
  using I32 = typename P::I32;
  using Floats = typename P::template Span<typename P::F32>;
  const typename P::Function function("refine_pose");
  work::Arena& local = machine.local();
  const work::Arena::Frame frame(local);
  // The results must not depend on the number of cores, so the sums are those of fixed parts.
  constexpr int kParts = 8;
  const MatrixView<P> partial = alloc_matrix<P>(local, "partial normal equations", kParts, kSums);
  const MatrixView<P> H = alloc_matrix<P>(local, "normal equations", kPoseUnknowns, kPoseUnknowns);
  const Floats b = local.alloc<Floats>("right-hand side", kPoseUnknowns);
  const auto numbers =
      local.alloc<typename P::template Span<I32>>("inliers per core", machine.cores());
  Pose<P> T = T_predicted;
  for ([[maybe_unused]] int step : P::range(0, options.steps)) {
    machine.fork("normal equations", [&](work::Core& core) {
      const auto [first, last] = core.share(kParts);
      for (int part : P::range(first, last)) {
        const Floats sums = partial.row(part);
        for (int i : P::range(0, kSums)) sums[i] = 0.0f;
        const auto [begin, end] = work::share_of(matches.n, part, kParts);
        for (int i : P::range(begin, end)) add_match<P>(matches, camera, T, options, i, sums);
      }
    });
    gather<P>(partial, H, b);
    add_prior<P>(T, T_predicted, options, H, b);
    if (!cholesky_factor<P>(H)) return {};
    cholesky_solve<P>(H, b);
    const Mat3<P> turn = so3_exp<P>(load_vec3<P>(b, 0));
    T = {turn * T.R, turn * T.t + load_vec3<P>(b, 3)};
  }
  machine.fork("inliers", [&](work::Core& core) {
    numbers[core.id] = mark_inliers<P>(matches, camera, T, options, core.share(matches.n), inliers);
  });
  I32 number = 0;
  for (int id : P::range(0, machine.cores())) number += I32(numbers[id]);
  return {true, T, work::value(number)};
}

#define LEVIOSIM_INSTANTIATE(P)                                                  \
  template RefinedPose<P> refine_pose(work::Machine&, const LandmarkMatches<P>&, \
                                      const PinholeCamera&, const Pose<P>&,      \
                                      const RefinementOptions&, P::Span<P::Byte>);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
