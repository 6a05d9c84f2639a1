// Orientation and descriptor as the released program computes them
// (PARAMETERS.md#feature-extraction): all positions of a 29×29 window are tested for the disc, and
// every coordinate of a pair is divided by 256 with a rounding that looks at its sign. Patterns of
// pairs are learned (learned_pairs.h).
//
// The release's rounding has a slip (PARAMETERS.md#defects-of-the-release), so its pattern is not
// rotated exactly and finds fewer matches. ExactDescriptor has the rounding that was meant.
#pragma once

#include "workload/vio/levio/vision/learned_pairs.h"
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

inline constexpr int kFractionBits = 8;
inline constexpr int kHalfPixel = 1 << (kFractionBits - 1);

/// Has the pattern of ORB's rules, and rounds a sum of two products in units of 1/256 px to the
/// nearest whole one.
struct ExactDescriptor {
  static constexpr work::CodeName kFunction{"levio_describe"};
  template <class P>
  static const auto& pattern() {
    return kLearnedPattern<P>;
  }
  template <class P>
  static typename P::I32 whole(typename P::I32 /*first*/, typename P::I32 sum) {
    using I = typename P::I32;
    if (sum < I(0)) return -((I(kHalfPixel) - sum) >> kFractionBits);
    return (sum + I(kHalfPixel)) >> kFractionBits;
  }
};

/// Has the pattern of the release's numbers of matches, and rounds with its slip: of a negative
/// sum, only the first product changes its sign before it is divided. So the dividend has either
/// sign, and the quotient is rounded to zero.
struct ReleasedDescriptor {
  static constexpr work::CodeName kFunction{"levio_describe_released"};
  template <class P>
  static const auto& pattern() {
    return kReleasedPattern<P>;
  }
  template <class P>
  static typename P::I32 whole(typename P::I32 first, typename P::I32 sum) {
    using I = typename P::I32;
    if (!(sum < I(0))) return (sum + I(kHalfPixel)) >> kFractionBits;
    const I dividend = sum - (first << 1) + I(kHalfPixel);
    const I if_negative = (dividend >> 31) & I((1 << kFractionBits) - 1);
    return -((dividend + if_negative) >> kFractionBits);
  }
};

/// A coordinate, the sum of `first` and another product, at most the descriptor's reach away. (The
/// release limits a negative sum on one side only, and reads outside of the image at times.)
template <class P, class Kind>
typename P::I32 nearest_pixel(typename P::I32 first, typename P::I32 sum) {
  using I = typename P::I32;
  const I pixel = Kind::template whole<P>(first, sum);
  return work::max(I(-kDescriptorReach), work::min(I(kDescriptorReach), pixel));
}

/// Level of the pixel at (x, y), turned into `direction`, from the pixel at index `centre`.
template <class P, class Kind>
typename P::I32 turned_sample(typename P::template Span<const typename P::Byte> image, int width,
                              int centre, const Direction<P>& direction, typename P::I32 x,
                              typename P::I32 y) {
  using I = typename P::I32;
  const I cos_x = direction.cos * x;
  const I sin_x = direction.sin * x;
  const I column = nearest_pixel<P, Kind>(cos_x, cos_x - direction.sin * y);
  const I row = nearest_pixel<P, Kind>(sin_x, sin_x + direction.cos * y);
  return image[I(row * I(width) + I(column + I(centre)))];
}

/// The descriptor of the feature at index `centre`; bits as in workload/vision/descriptor.h.
/// @tparam Kind  ExactDescriptor or ReleasedDescriptor
/// @param pattern  four signed bytes per pair: x1, y1, x2, y2
template <class P, class Kind>
void describe(typename P::template Span<const typename P::Byte> image, int width, int centre,
              const Direction<P>& direction,
              typename P::template Span<const typename P::U32> pattern,
              typename P::template Span<typename P::U32> descriptor) {
  using I = typename P::I32;
  using U = typename P::U32;
  const typename P::Function function(Kind::kFunction);
  constexpr int kWordBits = 32;
  for (int word : P::range(0, kDescriptorWords)) {
    U bits = 0u;
    for (int k : P::range(0, kWordBits)) {
      const U pair = pattern[word * kWordBits + k];
      const I x1 = I(pair) >> 24;
      const I y1 = I(pair << 8) >> 24;
      const I x2 = I(pair << 16) >> 24;
      const I y2 = I(pair << 24) >> 24;
      const I first = turned_sample<P, Kind>(image, width, centre, direction, x1, y1);
      const I second = turned_sample<P, Kind>(image, width, centre, direction, x2, y2);
      const U darker = U(I(first - second)) >> 31;
      bits = (bits << 1) | darker;
    }
    descriptor[word] = bits;
  }
}

}  // namespace leviosim::vio::levio
