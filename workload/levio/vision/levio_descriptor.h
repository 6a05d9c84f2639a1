// Orientation and descriptor as the released program computes them
// (PARAMETERS.md#feature-extraction): all positions of a 29×29 window are tested for the disc, and
// every coordinate of a pair is divided by 256 with a rounding that looks at its sign. Patterns of
// pairs are learned (learned_pairs.h).
//
// The release's rounding has a slip (PARAMETERS.md#defects-of-the-release), so its pattern is not
// rotated exactly and finds fewer matches. ExactDescriptor has the rounding that was meant.
#pragma once

#include "workload/levio/vision/learned_pairs.h"
#include "workload/vision/descriptor.h"

namespace leviosim::vio::levio {

inline constexpr int kWindowRadius = 14;
inline constexpr int kSquaredDiscRadius = 15 * 15;  ///< strictly above

/// First moments of the disc of 697 pixels whose distance from the pixel at index `centre` is below
/// 15; the window must lie inside the image.
template <class P>
LEVIOSIM_HOST_INLINE Moments<P> disc_moments(
    typename P::template Span<const typename P::Byte> image, int width, int centre) {
  using I = typename P::I32;
  const typename P::Function function("levio_disc_moments");
  I m10 = 0;
  I m01 = 0;
  for (int dy : P::range(-kWindowRadius, kWindowRadius + 1))
    for (int dx : P::range(-kWindowRadius, kWindowRadius + 1)) {
      const I squared = I(dx) * I(dx) + I(I(dy) * I(dy));
      if (squared >= I(kSquaredDiscRadius)) continue;
      const I v = image[centre + dy * width + dx];
      m10 += I(dx) * v;
      m01 += I(dy) * v;
    }
  return {m10, m01};
}

inline constexpr int kFractionBits = 8;
inline constexpr int kHalfPixel = 1 << (kFractionBits - 1);

/// A coordinate, the sum of `first` and another product, at most the descriptor's reach away. (The
/// release limits a negative sum on one side only, and reads outside of the image at times.)
template <class P, class Kind>
LEVIOSIM_HOST_INLINE typename P::I32 nearest_pixel(typename P::I32 first, typename P::I32 sum) {
  using I = typename P::I32;
  const I pixel = Kind::template whole<P>(first, sum);
  return work::max(I(-kDescriptorReach), work::min(I(kDescriptorReach), pixel));
}

/// The points of a pattern for vio::describe(), each coordinate rounded as `Kind` does.
template <class Kind>
struct TurnedPoints {
  template <class P>
  LEVIOSIM_HOST_INLINE static typename P::I32 index(int width, int centre,
                                                    const Direction<P>& direction,
                                                    typename P::I32 x, typename P::I32 y) {
    using I = typename P::I32;
    const I cos_x = direction.cos * x;
    const I sin_x = direction.sin * x;
    const I column = nearest_pixel<P, Kind>(cos_x, cos_x - direction.sin * y);
    const I row = nearest_pixel<P, Kind>(sin_x, sin_x + direction.cos * y);
    return row * I(width) + I(column + I(centre));
  }
};

/// Has the pattern of ORB's rules, and rounds a sum of two products in units of 1/256 px to the
/// nearest whole one.
struct ExactDescriptor : TurnedPoints<ExactDescriptor> {
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
struct ReleasedDescriptor : TurnedPoints<ReleasedDescriptor> {
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

}  // namespace leviosim::vio::levio
