// Rotated binary descriptor of a feature (Calonder et al. 2010, BRIEF; Rublee et al. 2011, ORB):
// 256 comparisons of pairs of blurred pixels, the pairs turned into the orientation of the feature.
//
// As in the released embedded code (PARAMETERS.md#feature-extraction): each point is rotated with
// sine and cosine in 8-bit fixed point, its coordinates are scaled back and clipped to ±15. The
// pattern itself is ours (pair_pattern.h), and that of `levio` another one.
#pragma once

#include "workload/math/host_value.h"
#include "workload/vision/features.h"
#include "workload/vision/host_kernels.h"
#include "workload/vision/orientation.h"
#include "workload/vision/pair_pattern.h"

namespace leviosim::vio {

/// A descriptor reads no farther from its feature than this, in columns and in rows.
inline constexpr int kDescriptorReach = 15;

/// How `next` turns the points of a pattern: coordinates are rounded to the nearest pixel.
struct RotatedPoints {
  static constexpr work::CodeName kFunction{"describe"};
  /// Index of the pixel at (x, y), turned into `direction`, from the pixel at index `centre`.
  template <class P>
  LEVIOSIM_HOST_INLINE static typename P::I32 index(int width, int centre,
                                                    const Direction<P>& direction,
                                                    typename P::I32 x, typename P::I32 y) {
    using I = typename P::I32;
    constexpr int kFractionBits = 8;
    const I half = 1 << (kFractionBits - 1);
    const I farthest = kDescriptorReach;
    const I nearest = -kDescriptorReach;
    const I u = (direction.cos * x - direction.sin * y + half) >> kFractionBits;
    const I v = (direction.sin * x + direction.cos * y + half) >> kFractionBits;
    const I column = work::max(nearest, work::min(farthest, u));
    const I row = work::max(nearest, work::min(farthest, v));
    return row * I(width) + (column + I(centre));
  }
};

/// The bits of a word; parameters as of describe().
template <class P, class Points, class Pattern>
LEVIOSIM_HOST_INLINE typename P::U32 compare_pairs(
    typename P::template Span<const typename P::Byte> image, int width, int centre,
    const Direction<P>& direction, Pattern pattern, int word) {
  using I = typename P::I32;
  using U = typename P::U32;
  U bits = 0u;
  for (int k : P::range(0, kWordBits)) {
    const U pair = pattern[word * kWordBits + k];
    const I x1 = I(pair) >> 24;
    const I y1 = I(pair << 8) >> 24;
    const I x2 = I(pair << 16) >> 24;
    const I y2 = I(pair << 24) >> 24;
    const I first = image[Points::template index<P>(width, centre, direction, x1, y1)];
    const I second = image[Points::template index<P>(width, centre, direction, x2, y2)];
    // The sign of the difference is the outcome of the comparison, without a branch.
    const U darker = U(I(first - second)) >> 31;
    bits = (bits << 1) | darker;
  }
  return bits;
}

/// compare_pairs() as it suits the host.
/// @param pairs  of the word
template <class Points, class Pixel, class Word>
LEVIOSIM_HOST_CLONES std::uint32_t compare_pairs_on_host(const Pixel* centre, int width,
                                                         const Direction<work::Native>& direction,
                                                         const Word* pairs) {
  return host::compare_pairs(centre, pairs, [&](std::int32_t x, std::int32_t y) {
    return Points::template index<work::Native>(width, 0, direction, x, y);
  });
}

/// Computes the descriptor of the feature at index `centre` of the blurred `image`. Bit k of the
/// descriptor, the highest of a word first, says whether the first point of pair k is darker than
/// the second. `Points`: RotatedPoints or what else has its members. `Pattern`: a span of kPairs
/// words (point_pairs.h) in whichever memory they lie.
template <class P, class Points, class Pattern>
void describe(typename P::template Span<const typename P::Byte> image, int width, int centre,
              const Direction<P>& direction, Pattern pattern,
              typename P::template Span<typename P::U32> descriptor) {
  const typename P::Function function(Points::kFunction);
  const Direction<work::Native> plain{work::value(direction.cos), work::value(direction.sin)};
  for (int word : P::range(0, kDescriptorWords))
    descriptor[word] = host_value(
        [&]() LEVIOSIM_HOST_INLINED {
          return compare_pairs<P, Points>(image, width, centre, direction, pattern, word);
        },
        [&] {
          return compare_pairs_on_host<Points>(image.data() + centre, width, plain,
                                               pattern.data() + kWordBits * word);
        });
}

}  // namespace leviosim::vio
