#include "workload/levio/geometry/essential_ransac.h"

#include "sim/base/check.h"
#include "workload/levio/geometry/eight_point.h"
#include "workload/levio/geometry/levio_inverse_power.h"
#include "workload/levio/geometry/svd.h"

namespace leviosim::vio::levio {
namespace {

/// What master and team exchange in a batch: element or row h belongs to hypothesis h.
template <class P>
struct EssentialBatch {
  template <class T>
  using Span = typename P::template Span<T>;
  using Byte = typename P::Byte;
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;

  EssentialBatch(work::Arena& a, int size, int matches)
      : indices(a.alloc<Span<U16>>("8-point samples", kEssentialSample * size)),
        essentials(alloc_matrix<P>(a, "8-point hypotheses", size, 9)),
        inliers(a.alloc<Span<I32>>("8-point inlier counts", size)),
        error_sums(a.alloc<Span<F>>("8-point error sums", size)),
        masks(a.alloc<Span<Byte>>("8-point inlier masks", size * matches)),
        matches_(matches) {}

  Span<U16> sample(int h) const { return indices.subspan(h * kEssentialSample, kEssentialSample); }
  MatrixView<P> essential(int h) const { return {essentials.row(h), 3, 3}; }
  EssentialScore<P> score(int h) const { return {inliers.subspan(h, 1), error_sums.subspan(h, 1)}; }
  Span<Byte> mask(int h) const { return masks.subspan(h * matches_, matches_); }

  Span<U16> indices;
  MatrixView<P> essentials;
  Span<I32> inliers;
  Span<F> error_sums;
  Span<Byte> masks;

 private:
  int matches_;
};

template <class P>
struct BestEssential {
  typename P::I32 inliers = 0;
  typename P::F32 mean_error = 1e30f;
};

/// More inliers, or as many with a smaller mean error. Without an inlier the mean is no number.
template <class P>
bool improves(typename P::I32 inliers, typename P::F32 mean_error, const BestEssential<P>& best) {
  if (inliers > best.inliers) return true;
  if (inliers < best.inliers) return false;
  return static_cast<bool>(mean_error < best.mean_error);
}

/// Of the first `size` hypotheses of a batch.
template <class P>
void keep_best(const EssentialBatch<P>& batch, int size, MatrixView<P> essential,
               typename P::template Span<typename P::Byte> inlier_mask, BestEssential<P>& best) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  for (int h : P::range(0, size)) {
    const I32 inliers = batch.inliers[h];
    const F mean_error = F(batch.error_sums[h]) / work::to_f32(inliers);
    if (!improves<P>(inliers, mean_error, best)) continue;
    best = {inliers, mean_error};
    copy<P>(essential, batch.essential(h));
    const auto mask = batch.mask(h);
    for (int m : P::range(0, mask.size()))
      inlier_mask[m] = work::narrow<typename P::Byte>(I32(mask[m]));
  }
}

/// What a hypothesis takes in a batch, and the scratch of the core that solves it.
Bytes size_of_hypothesis(int matches) {
  return Bytes(2LL * kEssentialSample + 4LL * (9 + 2) + matches) + kEssentialScratch;
}

}  // namespace

Bytes essential_memory(int matches, int cores) {
  return Bytes(2LL * matches) + size_of_hypothesis(matches) * cores;
}

template <class P>
EssentialResult<P> estimate_essential(work::Machine& machine, const TwoViewMatches<P>& matches,
                                      typename P::F32 threshold, ShiftRegister<P>& random,
                                      const EssentialRansacOptions& options,
                                      MatrixView<P> essential,
                                      typename P::template Span<typename P::Byte> inlier_mask) {
  using Indices = typename P::template Span<typename P::U16>;
  const typename P::Function function("levio_estimate_essential");
  check(matches.n >= kEssentialSample && matches.n <= 65535,
        "the 8-point algorithm draws samples of 8 of its matches");
  work::Arena& local = machine.local();
  const work::Arena::Frame frame(local);
  const Indices numbers = local.alloc<Indices>("8-point indices", matches.n);
  const Batches batches(options.iterations, options.batch, machine, size_of_hypothesis(matches.n));
  const EssentialBatch<P> batch(local, batches.largest(), matches.n);
  number_consecutively<P>(numbers);
  BestEssential<P> best;
  for (int i : P::range(0, batches.count())) {
    const int size = batches.size(i);
    for (int h : P::range(0, size))
      draw_sample<P>(random, numbers, kEssentialSample, batch.sample(h));
    machine.fork_aligned_on_one_core(
        "8-point hypotheses",
        [&](work::Core& core) {
          const auto [begin, end] = core.share(size);
          for (int h : P::range(begin, end))
            essential_from_sample<P>(matches, batch.sample(h), batch.essential(h), core.scratch);
        },
        kEssentialScratch);
    machine.fork_aligned_on_one_core("8-point scoring", [&](work::Core& core) {
      const auto [begin, end] = core.share(size);
      for (int h : P::range(begin, end))
        score_essential<P>(batch.essential(h), matches, threshold, batch.mask(h), batch.score(h));
    });
    keep_best<P>(batch, size, essential, inlier_mask, best);
  }
  const int inliers = work::value(best.inliers);
  return {inliers > 0, inliers};
}

#define LEVIOSIM_INSTANTIATE(P)                                                                    \
  template EssentialResult<P> estimate_essential(work::Machine&, const TwoViewMatches<P>&, P::F32, \
                                                 ShiftRegister<P>&, const EssentialRansacOptions&, \
                                                 MatrixView<P>, P::Span<P::Byte>);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

namespace {

constexpr int kElements = 9;  ///< of an essential matrix, row by row

/// HᵀH, the rows of H added one match after the other: 81 elements are read and written for each.
template <class P>
void accumulate_normal_matrix(const TwoViewMatches<P>& matches,
                              typename P::template Span<const typename P::U16> sample,
                              MatrixView<P> normal) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const typename P::Function function("levio_accumulate_epipolar_matrix");
  typename P::template Array<F, kElements> row;
  fill<P>(normal, 0.0f);
  for (int i : P::range(0, sample.size())) {
    const I32 x = I32(sample[i]) << 1;
    const I32 y = x + I32(1);
    const F ax = matches.a[x], ay = matches.a[y];
    const F bx = matches.b[x], by = matches.b[y];
    row[0] = bx * ax;
    row[1] = bx * ay;
    row[2] = bx;
    row[3] = by * ax;
    row[4] = by * ay;
    row[5] = by;
    row[6] = ax;
    row[7] = ay;
    row[8] = 1.0f;
    for (int r : P::range(0, kElements)) {
      const F factor = row[r];
      for (int c : P::range(0, kElements)) normal(r, c) += factor * row[c];
    }
  }
}

/// U diag(σ, σ, 0) Vᵀ, σ the mean of the two largest singular values, by two products.
template <class P>
void make_essential(MatrixView<P> result, MatrixView<P> matrix, work::Arena& scratch) {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;
  const typename P::Function function("levio_make_essential");
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> u = alloc_matrix<P>(scratch, "U", 3, 3);
  const MatrixView<P> v = alloc_matrix<P>(scratch, "V", 3, 3);
  const MatrixView<P> middle = alloc_matrix<P>(scratch, "equal singular values", 3, 3);
  const MatrixView<P> left = alloc_matrix<P>(scratch, "U times singular values", 3, 3);
  const Span s = scratch.alloc<Span>("singular values", 3);
  svd<P>(matrix, u, s, v, scratch);
  const F mean = F(F(s[0]) + F(s[1])) * F(0.5f);
  fill<P>(middle, 0.0f);
  middle(0, 0) = mean;
  middle(1, 1) = mean;
  product<P>(left, plain<P>(u), plain<P>(middle));
  product<P>(result, plain<P>(left), transposed<P>(v));
}

}  // namespace

template <class P>
int essential_from_sample(const TwoViewMatches<P>& matches,
                          typename P::template Span<const typename P::U16> sample,
                          MatrixView<P> essential, work::Arena& scratch) {
  const typename P::Function function("levio_essential_from_sample");
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> normal = alloc_matrix<P>(scratch, "8-point HtH", kElements, kElements);
  const MatrixView<P> fitted = alloc_matrix<P>(scratch, "8-point null vector", 3, 3);
  accumulate_normal_matrix<P>(matches, sample, normal);
  const int steps = smallest_eigenvector<P>(normal, fitted.data());
  make_essential<P>(essential, fitted, scratch);
  return steps;
}

template <class P>
void score_essential(MatrixView<P> essential, const TwoViewMatches<P>& matches,
                     typename P::F32 threshold,
                     typename P::template Span<typename P::Byte> inlier_mask,
                     const EssentialScore<P>& score) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const typename P::Function function("levio_score_essential");
  score.inliers[0] = 0;
  score.error_sum[0] = 0.0f;
  for (int i : P::range(0, matches.n)) {
    // The byte that is written may lie in E for all that the compiler knows, so E is read anew.
    Mat3<P> E;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) E.m[r][c] = F(essential(r, c));
    const F error = sampson_error_sq<P>(E, matches.in_a(i), matches.in_b(i));
    I32 inlier = 0;
    if (error < threshold) {
      inlier = 1;
      score.inliers[0] += I32(1);
      score.error_sum[0] += error;
    }
    inlier_mask[i] = work::narrow<typename P::Byte>(inlier);
  }
}

#define LEVIOSIM_INSTANTIATE(P)                                                                    \
  template int essential_from_sample(const TwoViewMatches<P>&, P::Span<const P::U16>,              \
                                     MatrixView<P>, work::Arena&);                                 \
  template void score_essential(MatrixView<P>, const TwoViewMatches<P>&, P::F32, P::Span<P::Byte>, \
                                const EssentialScore<P>&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio::levio
