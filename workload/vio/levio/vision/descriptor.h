// Orientation and descriptor as the released program computes them
// (PARAMETERS.md#feature-extraction): all positions of a 29×29 window are tested for the disc, and
// every coordinate of a pair is divided by 256 with a rounding that looks at its sign. The pattern
// of pairs is that of workload/vision/pair_pattern.h.
//
// Left out: the slip of the release in that rounding, which is no reason for cycles
// (PARAMETERS.md#defects-of-the-release).
#pragma once

#include "workload/vision/descriptor.h"

namespace leviosim::vio::levio {

inline constexpr int kWindowRadius = 14;

/// First moments of the disc of 697 pixels whose distance from the pixel at index `centre` is below
/// 15; the window must lie inside the image.
template <class P>
Moments<P> disc_moments(typename P::template Span<const typename P::Byte> image, int width,
                        int centre) {
  using I = typename P::I32;
  const typename P::Function function("levio_disc_moments");
  constexpr int kDiscRadius = 15;
  I m10 = 0;
  I m01 = 0;
  for (int dy : P::range(-kWindowRadius, kWindowRadius + 1))
    for (int dx : P::range(-kWindowRadius, kWindowRadius + 1)) {
      const I squared = I(dx) * I(dx) + I(I(dy) * I(dy));
      if (squared >= I(kDiscRadius * kDiscRadius)) continue;
      const I v = image[centre + dy * width + dx];
      m10 += I(dx) * v;
      m01 += I(dy) * v;
    }
  return {m10, m01};
}

/// A coordinate in units of 1/256 px to the nearest pixel, at most the descriptor's reach away.
template <class P>
typename P::I32 nearest_pixel(typename P::I32 fixed) {
  using I = typename P::I32;
  constexpr int kFractionBits = 8;
  const I half = 1 << (kFractionBits - 1);
  I pixel = 0;
  if (fixed < I(0))
    pixel = -((half - fixed) >> kFractionBits);
  else
    pixel = (fixed + half) >> kFractionBits;
  return work::max(I(-kDescriptorReach), work::min(I(kDescriptorReach), pixel));
}

/// Level of the pixel at (x, y), turned into `direction`, from the pixel at index `centre`.
template <class P>
typename P::I32 turned_sample(typename P::template Span<const typename P::Byte> image, int width,
                              int centre, const Direction<P>& direction, typename P::I32 x,
                              typename P::I32 y) {
  using I = typename P::I32;
  const I column = nearest_pixel<P>(direction.cos * x - direction.sin * y);
  const I row = nearest_pixel<P>(direction.sin * x + direction.cos * y);
  return image[I(row * I(width) + I(column + I(centre)))];
}

/// The descriptor of the feature at index `centre`; bits as in workload/vision/descriptor.h.
/// @param pattern  four signed bytes per pair: x1, y1, x2, y2
template <class P>
void describe(typename P::template Span<const typename P::Byte> image, int width, int centre,
              const Direction<P>& direction,
              typename P::template Span<const typename P::U32> pattern,
              typename P::template Span<typename P::U32> descriptor) {
  using I = typename P::I32;
  using U = typename P::U32;
  const typename P::Function function("levio_describe");
  constexpr int kWordBits = 32;
  for (int word : P::range(0, kDescriptorWords)) {
    U bits = 0u;
    for (int k : P::range(0, kWordBits)) {
      const U pair = pattern[word * kWordBits + k];
      const I x1 = I(pair) >> 24;
      const I y1 = I(pair << 8) >> 24;
      const I x2 = I(pair << 16) >> 24;
      const I y2 = I(pair << 24) >> 24;
      const I first = turned_sample<P>(image, width, centre, direction, x1, y1);
      const I second = turned_sample<P>(image, width, centre, direction, x2, y2);
      const U darker = U(I(first - second)) >> 31;
      bits = (bits << 1) | darker;
    }
    descriptor[word] = bits;
  }
}

}  // namespace leviosim::vio::levio
