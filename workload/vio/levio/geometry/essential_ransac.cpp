#include "workload/vio/levio/geometry/essential_ransac.h"

#include "sim/base/check.h"

namespace leviosim::vio::levio {
namespace {

/// What master and team exchange in a batch: element or row h belongs to hypothesis h.
template <class P>
struct Batch {
  template <class T>
  using Span = typename P::template Span<T>;
  using Byte = typename P::Byte;
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;

  Batch(work::Arena& a, int size, int matches)
      : indices(a.alloc<Span<U16>>("8-point samples", kEssentialSample * size)),
        essentials(alloc_matrix<P>(a, "8-point hypotheses", size, 9)),
        inliers(a.alloc<Span<I32>>("8-point inlier counts", size)),
        error_sums(a.alloc<Span<F>>("8-point error sums", size)),
        masks(a.alloc<Span<Byte>>("8-point inlier masks", size * matches)),
        matches_(matches) {}

  int size() const { return inliers.size(); }
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
struct Best {
  typename P::I32 inliers = 0;
  typename P::F32 mean_error = 1e30f;
};

/// More inliers, or as many with a smaller mean error. Without an inlier the mean is no number.
template <class P>
bool improves(typename P::I32 inliers, typename P::F32 mean_error, const Best<P>& best) {
  if (inliers > best.inliers) return true;
  if (inliers < best.inliers) return false;
  return static_cast<bool>(mean_error < best.mean_error);
}

template <class P>
void keep_best(const Batch<P>& batch, MatrixView<P> essential,
               typename P::template Span<typename P::Byte> inlier_mask, Best<P>& best) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  for (int h : P::range(0, batch.size())) {
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

}  // namespace

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
  const Batch<P> batch(local, options.batch, matches.n);
  number_consecutively<P>(numbers);
  Best<P> best;
  for ([[maybe_unused]] int i : P::range(0, options.iterations / options.batch)) {
    for (int h : P::range(0, options.batch))
      draw_sample<P>(random, numbers, kEssentialSample, batch.sample(h));
    machine.fork_aligned_on_one_core("8-point hypotheses", [&](work::Core& core) {
      const auto [begin, end] = core.share(options.batch);
      for (int h : P::range(begin, end))
        essential_from_sample<P>(matches, batch.sample(h), batch.essential(h), core.scratch);
    });
    machine.fork_aligned_on_one_core("8-point scoring", [&](work::Core& core) {
      const auto [begin, end] = core.share(options.batch);
      for (int h : P::range(begin, end))
        score_essential<P>(batch.essential(h), matches, threshold, batch.mask(h), batch.score(h));
    });
    keep_best<P>(batch, essential, inlier_mask, best);
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

}  // namespace leviosim::vio::levio
