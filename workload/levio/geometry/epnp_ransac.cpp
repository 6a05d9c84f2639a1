#include "workload/levio/geometry/epnp_ransac.h"

#include "sim/base/check.h"
#include "workload/levio/geometry/pose_matrix.h"

namespace leviosim::vio::levio {
namespace {

/// What master and team exchange in a batch: element or row h belongs to hypothesis h.
template <class P>
struct EpnpBatch {
  using Indices = typename P::template Span<typename P::U16>;
  using Span = typename P::template Span<typename P::F32>;

  EpnpBatch(work::Arena& a, int size)
      : indices(a.alloc<Indices>("samples", kEpnpSample * size)),
        points(alloc_matrix<P>(a, "sample points", size, 3 * kEpnpSample)),
        pixels(alloc_matrix<P>(a, "sample pixels", size, 2 * kEpnpSample)),
        poses(alloc_matrix<P>(a, "pose hypotheses", size, 16)),
        errors(a.alloc<Span>("errors of the samples", size)) {}

  Indices sample(int h) const { return indices.subspan(h * kEpnpSample, kEpnpSample); }
  EpnpSample<P> matches(int h) const {
    return {{points.row(h), kEpnpSample, 3}, {pixels.row(h), kEpnpSample, 2}};
  }
  MatrixView<P> pose(int h) const { return {poses.row(h), 4, 4}; }

  Indices indices;
  MatrixView<P> points, pixels, poses;
  Span errors;
};

template <class P>
void copy_sample(const LandmarkMatches<P>& matches, const EpnpBatch<P>& batch, int h) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const typename P::Function function("levio_copy_sample");
  const EpnpSample<P> to = batch.matches(h);
  for (int i : P::range(0, kEpnpSample)) {
    const I32 match = batch.sample(h)[i];
    const I32 point = match * I32(3);
    const I32 pixel = match * I32(2);
    for (int c = 0; c < 3; ++c) to.points(i, c) = F(matches.points[I32(point + I32(c))]);
    for (int c = 0; c < 2; ++c) to.pixels(i, c) = F(matches.pixels[I32(pixel + I32(c))]);
  }
}

/// How many matches a pose explains. Points behind the camera take the whole way.
template <class P>
typename P::I32 count_inliers(MatrixView<P> T_camera_world, const LandmarkMatches<P>& matches,
                              const CameraConstants<P>& camera, typename P::F32 inlier_px) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const typename P::Function function("levio_count_inliers");
  PointMover<P> into_camera(T_camera_world);
  I32 inliers = 0;
  for (int i : P::range(0, matches.n)) {
    const Vec3<P> point{F(matches.points[3 * i]), F(matches.points[3 * i + 1]),
                        F(matches.points[3 * i + 2])};
    const Vec3<P> x = into_camera(point);
    const F du = camera.fx() * F(x.x / x.z) + camera.cx() - matches.pixels[2 * i];
    const F dv = camera.fy() * F(x.y / x.z) + camera.cy() - matches.pixels[2 * i + 1];
    const F error = work::sqrt(F(du * du + dv * dv)) + depth_penalty<P>(x.z);
    if (error < inlier_px) inliers += I32(1);
  }
  return inliers;
}

template <class P>
struct BestPose {
  typename P::I32 inliers = 0;
  typename P::F32 error_px = 1e30f;  ///< of its sample
  bool found = false;
};

/// More inliers, or as many and a smaller error of its own sample.
template <class P>
bool improves(typename P::I32 inliers, typename P::F32 error_px, const BestPose<P>& best) {
  if (inliers > best.inliers) return true;
  if (inliers < best.inliers) return false;
  return static_cast<bool>(error_px < best.error_px);
}

/// Scores the first `size` hypotheses of a batch one after the other; the best pose stays in
/// `pose`.
template <class P>
void keep_best(const EpnpBatch<P>& batch, int size, const LandmarkMatches<P>& matches,
               const CameraConstants<P>& camera, float inlier_px, MatrixView<P> pose,
               BestPose<P>& best) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  for (int h : P::range(0, size)) {
    const I32 inliers = count_inliers<P>(batch.pose(h), matches, camera, F(inlier_px));
    const F error = batch.errors[h];
    if (!improves<P>(inliers, error, best)) continue;
    best = {inliers, error, true};
    copy<P>(pose, batch.pose(h));
  }
}

/// What a hypothesis takes in a batch, and the scratch of the core that solves it.
constexpr Bytes kEpnpHypothesis =
    Bytes(2 * kEpnpSample + 4 * (5 * kEpnpSample + 16 + 1)) + kEpnpScratch;

}  // namespace

Bytes epnp_memory(int matches, int cores) {
  return Bytes(2LL * matches + 4LL * 16) + kEpnpHypothesis * cores;
}

template <class P>
EpnpResult<P> estimate_pose_epnp(work::Machine& machine, const LandmarkMatches<P>& matches,
                                 const CameraConstants<P>& camera, ShiftRegister<P>& random,
                                 const EpnpRansacOptions& options) {
  using Indices = typename P::template Span<typename P::U16>;
  const typename P::Function function("levio_estimate_pose_epnp");
  check(matches.n >= kEpnpSample && matches.n <= 65535, "EPnP draws samples of 4 of its matches");
  work::Arena& local = machine.local();
  const work::Arena::Frame frame(local);
  const Indices numbers = local.alloc<Indices>("match numbers", matches.n);
  const Batches batches(options.iterations, options.batch, machine, kEpnpHypothesis);
  const EpnpBatch<P> batch(local, batches.largest());
  const MatrixView<P> pose = alloc_matrix<P>(local, "best pose", 4, 4);
  number_consecutively<P>(numbers);
  BestPose<P> best;
  for (int i : P::range(0, batches.count())) {
    const int size = batches.size(i);
    for (int h : P::range(0, size)) {
      draw_sample<P>(random, numbers, kEpnpSample, batch.sample(h));
      copy_sample<P>(matches, batch, h);
    }
    machine.fork(
        "solve EPnP",
        [&](work::Core& core) {
          const auto [begin, end] = core.share(size);
          for (int h : P::range(begin, end))
            batch.errors[h] = solve_epnp<P>(batch.matches(h), camera, batch.pose(h), core.scratch);
        },
        kEpnpScratch);
    keep_best<P>(batch, size, matches, camera, options.inlier_px, pose, best);
  }
  if (!best.found) return {};
  return {true, load_pose<P>(pose), work::value(best.inliers)};
}

#define LEVIOSIM_INSTANTIATE(P)                                                           \
  template EpnpResult<P> estimate_pose_epnp(work::Machine&, const LandmarkMatches<P>&,    \
                                            const CameraConstants<P>&, ShiftRegister<P>&, \
                                            const EpnpRansacOptions&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio::levio
