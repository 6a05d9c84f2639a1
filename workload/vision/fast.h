// FAST-9 corner test: nine or more consecutive pixels of the 16-pixel ring around a pixel are all
// brighter, or all darker, than the centre by more than a threshold (Rosten and Drummond 2006;
// paper section III, "ORB").
//
// As in the released embedded code (PARAMETERS.md#feature-extraction), every pixel is tested
// without early exit: 16 differences, then the run lengths of "brighter" and "darker", continued 8
// steps past the wrap. Left out: non-maximum suppression and the FAST score (corners are ranked by
// harris.h).
#pragma once

#include <array>

#include "sim/work/policy.h"
#include "workload/math/compilers.h"

namespace leviosim::vio {

inline constexpr int kRingSize = 16;
/// Consecutive ring pixels that make a corner.
inline constexpr int kFastArc = 9;
/// A corner test reads this far from its centre.
inline constexpr int kRingRadius = 3;

struct RingPoint {
  int dx, dy;
};

/// The digital circle of radius 3, clockwise from the top (image rows grow downwards).
inline constexpr std::array<RingPoint, kRingSize> kRing = {{{0, -3},
                                                            {1, -3},
                                                            {2, -2},
                                                            {3, -1},
                                                            {3, 0},
                                                            {3, 1},
                                                            {2, 2},
                                                            {1, 3},
                                                            {0, 3},
                                                            {-1, 3},
                                                            {-2, 2},
                                                            {-3, 1},
                                                            {-3, 0},
                                                            {-3, -1},
                                                            {-2, -2},
                                                            {-1, -3}}};

/// Writes the ring as offsets in an image of `width` pixels per row.
template <class P>
void fill_ring_offsets(int width, typename P::template Span<typename P::I32> offsets) {
  using I = typename P::I32;
  for (int k : P::range(0, kRingSize)) offsets[k] = I(kRing[k].dy) * I(width) + I(kRing[k].dx);
}

/// Whether the pixel at index `centre` is a corner. `offsets`: see fill_ring_offsets; the ring must
/// lie inside the image. `threshold`: grey levels, strictly exceeded.
template <class P>
LEVIOSIM_HOST_INLINE typename P::Bool is_fast_corner(
    typename P::template Span<const typename P::Byte> image, int centre,
    typename P::template Span<const typename P::I32> offsets, typename P::I32 threshold) {
  using I = typename P::I32;
  const typename P::Code code("is_fast_corner");
  const I centre_level = image[centre];
  typename P::template Array<I, kRingSize> difference;
  for (int k : P::range(0, kRingSize)) {
    const I at = offsets[k] + I(centre);
    difference[k] = image[at] - centre_level;
  }

  I brighter = 0;
  I darker = 0;
  I longest = 0;
  // The sign of a difference, spread over the word, keeps a run or clears it without a branch: what
  // a compiler makes of `d > threshold ? brighter + 1 : 0`.
  const auto extend_runs = [&](I d) {
    brighter = (brighter + I(1)) & ((threshold - d) >> 31);
    darker = (darker + I(1)) & ((d + threshold) >> 31);
    longest = work::max(longest, work::max(brighter, darker));
  };
  for (int k : P::range(0, kRingSize)) extend_runs(difference[k]);
  for (int k : P::range(0, kFastArc - 1)) extend_runs(difference[k]);
  return longest >= I(kFastArc);
}

}  // namespace leviosim::vio
