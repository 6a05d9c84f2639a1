#include "workload/geometry/essential_ransac.h"

#include <algorithm>

#include "sim/base/check.h"
#include "workload/geometry/random.h"
#include "workload/math/inverse_power.h"
#include "workload/math/matrix.h"
#include "workload/math/svd.h"

namespace leviosim::vio {
namespace {

/// What the master and the team exchange in one batch: element h (row h) belongs to hypothesis h.
template <class P>
struct Batch {
  template <class T>
  using Span = typename P::template Span<T>;
  using Byte = typename P::Byte;
  using U16 = typename P::U16;

  Batch(work::Arena& arena, int size, int sample_size, int matches)
      : samples(arena.alloc<Span<U16>>("8-point samples", size * sample_size)),
        essentials(arena.alloc<Span<typename P::F32>>("8-point hypotheses", size * 9)),
        inliers(arena.alloc<Span<typename P::I32>>("8-point inlier counts", size)),
        masks(arena.alloc<Span<Byte>>("8-point inlier masks", size * matches)),
        sample_size_(sample_size),
        matches_(matches) {}

  Span<U16> sample(int h) const { return samples.subspan(h * sample_size_, sample_size_); }
  Span<Byte> mask(int h) const { return masks.subspan(h * matches_, matches_); }
  Mat3<P> essential(int h) const {
    const auto e = essentials.subspan(h * 9, 9);
    return {{{e[0], e[1], e[2]}, {e[3], e[4], e[5]}, {e[6], e[7], e[8]}}};
  }
  void store_essential(int h, const Mat3<P>& E) const {
    const auto e = essentials.subspan(h * 9, 9);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) e[3 * r + c] = E.m[r][c];
  }

  Span<U16> samples;
  Span<typename P::F32> essentials;
  Span<typename P::I32> inliers;
  Span<Byte> masks;

 private:
  int sample_size_;
  int matches_;
};

template <class P>
void fork_hypotheses(work::Machine& machine, const TwoViewMatches<P>& matches,
                     const EssentialOptions& options, const Batch<P>& batch, int size) {
  machine.fork("8-point hypotheses", [&](work::Core& core) {
    const auto [begin, end] = core.share(size);
    for (int h : P::range(begin, end))
      batch.store_essential(
          h, essential_from_sample<P>(matches, batch.sample(h), options.solver, core.scratch));
  });
}

template <class P>
void fork_scoring(work::Machine& machine, const TwoViewMatches<P>& matches,
                  typename P::F32 threshold, const Batch<P>& batch, int size) {
  machine.fork("8-point scoring", [&](work::Core& core) {
    const auto [begin, end] = core.share(size);
    for (int h : P::range(begin, end))
      batch.inliers[h] = score_essential<P>(batch.essential(h), matches, threshold, batch.mask(h));
  });
}

}  // namespace

template <class P>
EssentialResult<P> estimate_essential(work::Machine& machine, const TwoViewMatches<P>& matches,
                                      float fx, const EssentialOptions& options,
                                      typename P::template Span<typename P::Byte> inlier_mask) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  check(options.sample >= 8 && options.batch >= 1, "8-point RANSAC: sample or batch too small");
  check(matches.n <= 65536, "8-point RANSAC: match indices have 16 bits");
  const typename P::Function function("estimate_essential");
  for (int i : P::range(0, matches.n)) inlier_mask[i] = work::narrow<typename P::Byte>(I32(0));
  EssentialResult<P> best{false, Mat3<P>::zero(), 0};
  if (matches.n < options.sample) return best;

  work::Arena& local = machine.local();
  const work::Arena::Frame frame(local);
  const auto indices =
      local.alloc<typename P::template Span<typename P::U16>>("8-point indices", matches.n);
  const Batch<P> batch(local, options.batch, options.sample, matches.n);
  const F pixel = F(options.inlier_px) / F(fx);
  const F threshold = pixel * pixel;
  Lfsr32<P> random(options.seed);
  number_consecutively<P>(indices);
  I32 most_inliers = options.sample - 1;  // a sample that its own matches do not fit is no result

  const int batches = (options.iterations + options.batch - 1) / options.batch;
  for (int i : P::range(0, batches)) {
    const int size = std::min(options.batch, options.iterations - i * options.batch);
    for (int h : P::range(0, size))
      draw_sample<P>(random, indices, matches.n, options.sample, batch.sample(h));
    fork_hypotheses<P>(machine, matches, options, batch, size);
    fork_scoring<P>(machine, matches, threshold, batch, size);
    for (int h : P::range(0, size)) {
      const I32 inliers = batch.inliers[h];
      if (inliers > most_inliers) {
        most_inliers = inliers;
        best = {true, batch.essential(h), work::value(inliers)};
        const auto mask = batch.mask(h);
        for (int m : P::range(0, matches.n))
          inlier_mask[m] = work::narrow<typename P::Byte>(I32(mask[m]));
      }
    }
  }
  return best;
}

template EssentialResult<work::Native> estimate_essential(work::Machine&,
                                                          const TwoViewMatches<work::Native>&,
                                                          float, const EssentialOptions&,
                                                          work::Native::Span<work::Native::Byte>);
template EssentialResult<work::Counting> estimate_essential(
    work::Machine&, const TwoViewMatches<work::Counting>&, float, const EssentialOptions&,
    work::Counting::Span<work::Counting::Byte>);

namespace {

/// One equation of x_bᵀ E x_a = 0 per match of the sample, in the unknowns of E row by row.
template <class P>
void write_epipolar_constraints(MatrixView<P> H, const TwoViewMatches<P>& matches,
                                typename P::template Span<const typename P::U16> sample) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  for (int i : P::range(0, H.rows())) {
    const I32 match = sample[i];
    const I32 x = match << 1;
    const I32 y = x + I32(1);
    const F ax = matches.a[x], ay = matches.a[y];
    const F bx = matches.b[x], by = matches.b[y];
    const auto h = H.row(i);
    h[0] = bx * ax;
    h[1] = bx * ay;
    h[2] = bx;
    h[3] = by * ax;
    h[4] = by * ay;
    h[5] = by;
    h[6] = ax;
    h[7] = ay;
    h[8] = 1.0f;
  }
}

/// U diag(s₁, s₂, 0) Vᵀ of the singular value decomposition of E.
template <class P>
Mat3<P> nearest_of_rank_2(const Mat3<P>& E, const EightPointOptions& options) {
  using F = typename P::F32;
  Mat3<P> U, V;
  Vec3<P> s;
  svd3<P>(E, U, s, V, options.max_svd_rotations, F(kSvdTolerance), options.svd_precision);
  Mat3<P> result;
  for (int r = 0; r < 3; ++r) {
    const F u0 = U.m[r][0] * s.x;
    const F u1 = U.m[r][1] * s.y;
    for (int c = 0; c < 3; ++c) result.m[r][c] = u0 * V.m[c][0] + u1 * V.m[c][1];
  }
  return result;
}

}  // namespace

template <class P>
Mat3<P> essential_from_sample(const TwoViewMatches<P>& matches,
                              typename P::template Span<const typename P::U16> sample,
                              const EightPointOptions& options, work::Arena& scratch) {
  using F = typename P::F32;
  const typename P::Function function("essential_from_sample");
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> HtH = alloc_matrix<P>(scratch, "8-point HᵀH", 9, 9);
  {
    const work::Arena::Frame constraints(scratch);
    const MatrixView<P> H = alloc_matrix<P>(scratch, "8-point H", sample.size(), 9);
    write_epipolar_constraints<P>(H, matches, sample);
    multiply_transposed<P>(HtH, H, H);
  }
  const auto e = scratch.alloc<typename P::template Span<F>>("8-point E", 9);
  smallest_eigenvector<P>(HtH, e, scratch, options.max_power_steps, F(options.power_tolerance));
  const Mat3<P> E = {{{e[0], e[1], e[2]}, {e[3], e[4], e[5]}, {e[6], e[7], e[8]}}};
  return nearest_of_rank_2<P>(E, options);
}

template <class P>
typename P::I32 score_essential(const Mat3<P>& E, const TwoViewMatches<P>& matches,
                                typename P::F32 threshold,
                                typename P::template Span<typename P::Byte> inlier_mask) {
  using I32 = typename P::I32;
  const typename P::Function function("score_essential");
  const TwoViewMatches<P> views = matches;
  I32 inliers = 0;
  for (int i : P::range(0, views.n)) {
    I32 inlier = 0;
    if (sampson_error_sq<P>(E, views.in_a(i), views.in_b(i)) < threshold) inlier = 1;
    inliers += inlier;
    inlier_mask[i] = work::narrow<typename P::Byte>(inlier);
  }
  return inliers;
}

#define LEVIOSIM_INSTANTIATE(P)                                                           \
  template Mat3<P> essential_from_sample(const TwoViewMatches<P>&, P::Span<const P::U16>, \
                                         const EightPointOptions&, work::Arena&);         \
  template P::I32 score_essential(const Mat3<P>&, const TwoViewMatches<P>&, P::F32,       \
                                  P::Span<P::Byte>);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
