// Rotated binary descriptor of a feature (Calonder et al. 2010, BRIEF; Rublee et al. 2011, ORB):
// 256 comparisons of pairs of blurred pixels, the pairs turned into the orientation of the feature.
//
// As in the released embedded code (PARAMETERS.md#feature-extraction): each point is rotated with
// sine and cosine in 8-bit fixed point, its coordinates are scaled back and clipped to ±15. The
// pattern itself is ours (pair_pattern.h), and that of `levio` another one.
#pragma once

#include "workload/vision/features.h"
#include "workload/vision/orientation.h"
#include "workload/vision/pair_pattern.h"

namespace leviosim::vio {

/// A descriptor reads no farther from its feature than this, in columns and in rows.
inline constexpr int kDescriptorReach = 15;

/// Level of the pixel at (x, y), turned into `direction`, from the pixel at index `centre`.
template <class P>
typename P::I32 rotated_sample(typename P::template Span<const typename P::Byte> image, int width,
                               int centre, const Direction<P>& direction, typename P::I32 x,
                               typename P::I32 y) {
  using I = typename P::I32;
  constexpr int kFractionBits = 8;
  const I half = 1 << (kFractionBits - 1);
  const I farthest = kDescriptorReach;
  const I nearest = -kDescriptorReach;
  const I u = (direction.cos * x - direction.sin * y + half) >> kFractionBits;
  const I v = (direction.sin * x + direction.cos * y + half) >> kFractionBits;
  const I column = work::max(nearest, work::min(farthest, u));
  const I row = work::max(nearest, work::min(farthest, v));
  const I at = row * I(width) + (column + I(centre));
  return image[at];
}

/// Computes the descriptor of the feature at index `centre` of the blurred `image`. Bit k of the
/// descriptor, the highest of a word first, says whether the first point of pair k is darker than
/// the second. `Pattern`: a span of kPairs words (point_pairs.h) in whichever memory they lie.
template <class P, class Pattern>
void describe(typename P::template Span<const typename P::Byte> image, int width, int centre,
              const Direction<P>& direction, Pattern pattern,
              typename P::template Span<typename P::U32> descriptor) {
  using I = typename P::I32;
  using U = typename P::U32;
  const typename P::Function function("describe");
  constexpr int kWordBits = 32;
  for (int word : P::range(0, kDescriptorWords)) {
    U bits = 0u;
    for (int k : P::range(0, kWordBits)) {
      const U pair = pattern[word * kWordBits + k];
      const I x1 = I(pair) >> 24;
      const I y1 = I(pair << 8) >> 24;
      const I x2 = I(pair << 16) >> 24;
      const I y2 = I(pair << 24) >> 24;
      const I first = rotated_sample<P>(image, width, centre, direction, x1, y1);
      const I second = rotated_sample<P>(image, width, centre, direction, x2, y2);
      // The sign of the difference is the outcome of the comparison, without a branch.
      const U darker = U(I(first - second)) >> 31;
      bits = (bits << 1) | darker;
    }
    descriptor[word] = bits;
  }
}

}  // namespace leviosim::vio
