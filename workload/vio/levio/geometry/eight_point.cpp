#include "workload/vio/levio/geometry/eight_point.h"

#include "workload/vio/levio/algebra/inverse_power.h"
#include "workload/vio/levio/algebra/svd.h"

namespace leviosim::vio::levio {
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
