// Orientation of a feature by the intensity centroid: the direction from the feature to the centre
// of mass of the grey levels in a disc of radius 15 around it (Rosin 1999; Rublee et al. 2011,
// ORB).
//
// As in the released embedded code (PARAMETERS.md#feature-extraction): moments of the blurred image
// in whole numbers, one atan2, sine and cosine in 8-bit fixed point.
#pragma once

#include <array>

#include "workload/math/compilers.h"
#include "workload/math/trig.h"

namespace leviosim::vio {

inline constexpr int kDiscRadius = 15;
inline constexpr int kDiscRows = 2 * kDiscRadius + 1;

/// Element dy + 15 is the largest dx with dx² + dy² ≤ 15²: a constant of the program image.
template <class P>
constexpr std::array<typename P::I32, kDiscRows> make_disc_half_widths() {
  std::array<typename P::I32, kDiscRows> half_widths{};
  for (int dy = -kDiscRadius; dy <= kDiscRadius; ++dy) {
    int dx = 0;
    while ((dx + 1) * (dx + 1) + dy * dy <= kDiscRadius * kDiscRadius) ++dx;
    half_widths[dy + kDiscRadius] = typename P::I32(dx);
  }
  return half_widths;
}
template <class P>
inline constexpr auto kDiscHalfWidths = make_disc_half_widths<P>();

/// First moments of the grey levels v about the centre: m10 = Σ dx v, m01 = Σ dy v.
template <class P>
struct Moments {
  typename P::I32 m10, m01;
};

/// Moments of the disc around the pixel at index `centre`; the disc must lie inside the image.
/// `half_widths`: kDiscHalfWidths, in the memory of the core.
template <class P>
LEVIOSIM_HOST_INLINE Moments<P> disc_moments(
    typename P::template Span<const typename P::Byte> image, int width, int centre,
    typename P::template Span<const typename P::I32> half_widths) {
  using I = typename P::I32;
  const typename P::Function function("disc_moments");
  I m10 = 0;
  I m01 = 0;
  for (int dy : P::range(-kDiscRadius, kDiscRadius + 1)) {
    const I half_width = half_widths[dy + kDiscRadius];
    const int row = centre + dy * width;
    I row_sum = 0;
    for (int dx : P::range(I(-half_width), I(half_width + I(1)))) {
      const I v = image[row + dx];
      row_sum += v;
      m10 += I(dx) * v;
    }
    m01 += I(dy) * row_sum;
  }
  return {m10, m01};
}

/// A direction in the image (rows grow downwards) in 8-bit fixed point: 256 stands for 1.
template <class P>
struct Direction {
  typename P::I32 cos, sin;
};

/// Direction of (m10, m01), components truncated towards zero; (0, 0) gives the direction of +x.
template <class P>
Direction<P> direction_of(const Moments<P>& moments) {
  using F = typename P::F32;
  const F angle = atan2_of<P>(work::to_f32(moments.m01), work::to_f32(moments.m10));
  const F one = 256.0f;
  return {work::to_i32(F(cos_of<P>(angle) * one)), work::to_i32(F(sin_of<P>(angle) * one))};
}

}  // namespace leviosim::vio
