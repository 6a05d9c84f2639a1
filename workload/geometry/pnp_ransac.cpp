#include "workload/geometry/pnp_ransac.h"

#include "sim/base/check.h"
#include "workload/geometry/camera_matrix.h"
#include "workload/geometry/random.h"

namespace leviosim::vio {
namespace {

/// What the team hands to the master: one entry per hypothesis of a batch.
template <class P>
struct Hypotheses {
  MatrixView<P> poses;                               ///< batch×12: R row by row, then t
  typename P::template Span<typename P::I32> valid;  ///< batch, 0 or 1
};

template <class P>
void store_pose(typename P::template Span<typename P::F32> row, const Pose<P>& pose) {
  for (int i = 0; i < 9; ++i) row[i] = pose.R.m[i / 3][i % 3];
  row[9] = pose.t.x;
  row[10] = pose.t.y;
  row[11] = pose.t.z;
}

template <class P>
Pose<P> load_pose(typename P::template Span<typename P::F32> row) {
  using F = typename P::F32;
  Pose<P> pose;
  for (int i = 0; i < 9; ++i) pose.R.m[i / 3][i % 3] = F(row[i]);
  pose.t = {F(row[9]), F(row[10]), F(row[11])};
  return pose;
}

template <class P>
struct Score {
  typename P::I32 inliers;
  typename P::F32 mean_error_px;
};

template <class P>
Score<P> count_inliers(const Pose<P>& T_camera_world, const PnpInput<P>& input, float inlier_px) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const typename P::Function function("count_inliers");
  const auto points = input.points;
  const auto pixels = input.pixels;
  const CameraMatrix<P> K = CameraMatrix<P>::of(input.camera);
  const F limit = inlier_px * inlier_px;
  I32 inliers = 0;
  F sum = 0.0f;
  for (int i : P::range(0, input.n)) {
    const Vec3<P> world{F(points[3 * i]), F(points[3 * i + 1]), F(points[3 * i + 2])};
    const Vec3<P> x = T_camera_world * world;
    if (x.z > 0.0f) {
      const Vec2<P> d = reprojection_difference<P>(K, x, pixels[2 * i], pixels[2 * i + 1]);
      const F squared = d.x * d.x + d.y * d.y;
      if (squared < limit) {
        inliers += 1;
        sum += work::sqrt(squared);
      }
    }
  }
  F mean = 0.0f;
  if (inliers > 0) mean = sum / work::to_f32(inliers);
  return {inliers, mean};
}

/// Better by inliers, then by error.
template <class P>
bool improves(const Score<P>& candidate, const Score<P>& best) {
  if (candidate.inliers > best.inliers) return true;
  if (candidate.inliers < best.inliers) return false;
  return static_cast<bool>(candidate.mean_error_px < best.mean_error_px);
}

/// Counts the inliers of every hypothesis, and keeps the best one's pose in `best_pose` (12).
template <class P>
void keep_best(const Hypotheses<P>& hypotheses, const PnpInput<P>& input, float inlier_px,
               typename P::template Span<typename P::F32> best_pose, Score<P>& best) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  for (int h : P::range(0, hypotheses.poses.rows())) {
    const I32 valid = hypotheses.valid[h];
    if (valid == 0) continue;
    const Score<P> score =
        count_inliers<P>(load_pose<P>(hypotheses.poses.row(h)), input, inlier_px);
    if (!improves<P>(score, best)) continue;
    best = score;
    for (int i : P::range(0, 12)) best_pose[i] = F(hypotheses.poses(h, i));
  }
}

}  // namespace

template <class P>
PnpResult<P> estimate_pose_epnp(work::Machine& machine, const PnpInput<P>& input,
                                const PnpOptions& options) {
  using I32 = typename P::I32;
  using F = typename P::F32;
  using Indices = typename P::template Span<typename P::U16>;
  const typename P::Function function("estimate_pose_epnp");
  check(options.sample >= 4 && options.batch >= 1,
        "EPnP RANSAC needs samples of 4 matches or more");
  check(input.n <= 65535, "matches are numbered in 16 bits");
  if (input.n < options.sample) return {};

  work::Arena& local = machine.local();
  const work::Arena::Frame frame(local);
  const Hypotheses<P> hypotheses{
      alloc_matrix<P>(local, "pose hypotheses", options.batch, 12),
      local.alloc<typename P::template Span<I32>>("valid hypotheses", options.batch)};
  const auto best_pose = local.alloc<typename P::template Span<F>>("best pose", 12);
  const Indices numbers = local.alloc<Indices>("match numbers", input.n);
  const Indices samples = local.alloc<Indices>("samples", options.batch * options.sample);
  const auto sample_of = [&](int h) { return samples.subspan(h * options.sample, options.sample); };
  number_consecutively<P>(numbers);
  Lfsr32<P> random(options.seed);
  Score<P> best{0, 0.0f};

  for ([[maybe_unused]] int batch : P::range(0, options.iterations / options.batch)) {
    for (int h : P::range(0, options.batch))
      draw_sample<P>(random, numbers, input.n, options.sample, sample_of(h));
    machine.fork("solve EPnP", [&](work::Core& core) {
      const auto [begin, end] = core.share(options.batch);
      for (int h : P::range(begin, end)) {
        const EpnpSolution<P> solution = solve_epnp<P>(input, sample_of(h), options, core.scratch);
        hypotheses.valid[h] = solution.valid ? 1 : 0;
        if (solution.valid) store_pose<P>(hypotheses.poses.row(h), solution.T_camera_world);
      }
    });
    keep_best<P>(hypotheses, input, options.inlier_px, best_pose, best);
  }
  const int inliers = work::value(best.inliers);
  if (inliers < options.sample) return {};
  return {true, load_pose<P>(best_pose), inliers, best.mean_error_px};
}

template PnpResult<work::Native> estimate_pose_epnp<work::Native>(work::Machine&,
                                                                  const PnpInput<work::Native>&,
                                                                  const PnpOptions&);
template PnpResult<work::Counting> estimate_pose_epnp<work::Counting>(
    work::Machine&, const PnpInput<work::Counting>&, const PnpOptions&);

}  // namespace leviosim::vio
