#include "workload/geometry/eight_point.h"

#include "workload/math/inverse_power.h"
#include "workload/math/matrix.h"
#include "workload/math/svd.h"

namespace leviosim::vio {
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

template Mat3<work::Native> essential_from_sample(const TwoViewMatches<work::Native>&,
                                                  work::Native::Span<const work::Native::U16>,
                                                  const EightPointOptions&, work::Arena&);
template Mat3<work::Counting> essential_from_sample(const TwoViewMatches<work::Counting>&,
                                                    work::Counting::Span<const work::Counting::U16>,
                                                    const EightPointOptions&, work::Arena&);
template work::Native::I32 score_essential(const Mat3<work::Native>&,
                                           const TwoViewMatches<work::Native>&, work::Native::F32,
                                           work::Native::Span<work::Native::Byte>);
template work::Counting::I32 score_essential(const Mat3<work::Counting>&,
                                             const TwoViewMatches<work::Counting>&,
                                             work::Counting::F32,
                                             work::Counting::Span<work::Counting::Byte>);

}  // namespace leviosim::vio
