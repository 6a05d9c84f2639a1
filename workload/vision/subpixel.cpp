#include "workload/vision/subpixel.h"

namespace leviosim::vio {
namespace {

/// That of the corner score (harris.h), for which the sums below do not overflow.
constexpr int kWindowRadius = 3;

/// Whole-number sums over the window; at most 49 · 1020² · 3 < 2^31.
template <class P>
struct GradientSums {
  typename P::I32 xx = 0, xy = 0, yy = 0;  ///< Σ g gᵀ
  typename P::I32 x = 0, y = 0;            ///< Σ g gᵀ p, p from the centre
};

template <class P>
GradientSums<P> sum_gradients(typename P::template Span<const typename P::Byte> image, int width,
                              int x, int y) {
  using I = typename P::I32;
  const typename P::Code code("sum_gradients");
  GradientSums<P> sums;
  for (int v : P::range(-kWindowRadius, kWindowRadius + 1))
    for (int u : P::range(-kWindowRadius, kWindowRadius + 1)) {
      const int level = (y + v) * width + x + u;
      const int above = level - width, below = level + width;
      const I nw = image[above - 1], n = image[above], ne = image[above + 1];
      const I w = image[level - 1], e = image[level + 1];
      const I sw = image[below - 1], s = image[below], se = image[below + 1];
      const I gx = (ne - nw) + ((e - w) << 1) + (se - sw);
      const I gy = (sw - nw) + ((s - n) << 1) + (se - ne);
      const I along = gx * I(u) + gy * I(v);
      sums.xx += gx * gx;
      sums.xy += gx * gy;
      sums.yy += gy * gy;
      sums.x += gx * along;
      sums.y += gy * along;
    }
  return sums;
}

}  // namespace

template <class P>
Vec2<P> corner_offset(typename P::template Span<const typename P::Byte> image, int width, int x,
                      int y, float max_shift) {
  using F = typename P::F32;
  const typename P::Function function("corner_offset");
  const GradientSums<P> sums = sum_gradients<P>(image, width, x, y);
  const F xx = work::to_f32(sums.xx), xy = work::to_f32(sums.xy), yy = work::to_f32(sums.yy);
  const F bx = work::to_f32(sums.x), by = work::to_f32(sums.y);
  const F determinant = xx * yy - xy * xy;
  if (!(determinant > 0.0f)) return {0.0f, 0.0f};
  const F scale = F(1.0f) / determinant;
  const F dx = (yy * bx - xy * by) * scale;
  const F dy = (xx * by - xy * bx) * scale;
  if (work::abs(dx) > F(max_shift) || work::abs(dy) > F(max_shift)) return {0.0f, 0.0f};
  return {dx, dy};
}

template <class P>
void refine_keypoints(work::Machine& machine, ConstImageView<P> image,
                      const ExtractorOptions& options, work::Share which,
                      const FeatureList<P>& features) {
  using F = typename P::F32;
  using I = typename P::I32;
  using U16 = typename P::U16;
  machine.fork("refine", [&](work::Core& core) {
    const auto [begin, end] = core.share(which.end - which.begin);
    const F unit = static_cast<float>(options.subpixel_steps);
    for (int i : P::range(which.begin + begin, which.begin + end)) {
      const I x = features.x[i], y = features.y[i];
      // The window around it is a stream from a computed place.
      Vec2<P> offset{0.0f, 0.0f};
      if (options.max_corner_shift > 0)
        offset = corner_offset<P>(image.pixels, image.width, work::value(x),
                                  work::value(y) - image.top, options.max_corner_shift);
      // To the nearest step; coordinates are positive.
      const F u = (work::to_f32(x) + offset.x) * unit + F(0.5f);
      const F v = (work::to_f32(y) + offset.y) * unit + F(0.5f);
      features.x[i] = work::narrow<U16>(work::to_i32(u));
      features.y[i] = work::narrow<U16>(work::to_i32(v));
    }
  });
}

#define LEVIOSIM_INSTANTIATE(P)                                                              \
  template Vec2<P> corner_offset(P::Span<const P::Byte>, int, int, int, float);              \
  template void refine_keypoints(work::Machine&, ConstImageView<P>, const ExtractorOptions&, \
                                 work::Share, const FeatureList<P>&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
