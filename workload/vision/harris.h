// Harris corner response (Harris and Stephens 1988), computed on FAST corners only (paper section
// III, "ORB").
//
// As in the released embedded code (PARAMETERS.md#feature-extraction): 3×3 Sobel gradients of the
// raw image in a 7×7 window, int32 sums shifted right by 11, response a·b − c² − (a + b)²/25 in
// whole numbers. Nothing overflows: gx² + gy² of one pixel is at most 1020² + 510², so a + b ≤ 49 ·
// 1 300 500 / 2^11 = 31 115 and its square stays below 2^31.
#pragma once

#include "sim/work/policy.h"
#include "workload/math/compilers.h"

namespace leviosim::vio {

/// The 7×7 window and its Sobel gradients read this far from the centre.
inline constexpr int kHarrisReach = 4;

/// The response of a window with these sums of gx², gy² and gx gy.
template <class P>
LEVIOSIM_HOST_INLINE typename P::I32 response_of_sums(typename P::I32 a, typename P::I32 b,
                                                      typename P::I32 c) {
  using I = typename P::I32;
  constexpr int kSumShift = 11;
  a >>= kSumShift;
  b >>= kSumShift;
  c >>= kSumShift;
  const I trace = a + b;
  const I trace_squared = trace * trace;
  return a * b - c * c - trace_squared / I(25);
}

/// Response at column x, row y; the window must lie inside the image. Positive for corners.
template <class P>
LEVIOSIM_HOST_INLINE typename P::I32 harris_response(
    typename P::template Span<const typename P::Byte> image, int width, int x, int y) {
  using I = typename P::I32;
  const typename P::Function function("harris_response");
  constexpr int kWindowRadius = 3;
  I a = 0;  // sum of gx²
  I b = 0;  // sum of gy²
  I c = 0;  // sum of gx gy
  for (int v : P::range(y - kWindowRadius, y + kWindowRadius + 1))
    for (int u : P::range(x - kWindowRadius, x + kWindowRadius + 1)) {
      const int above = (v - 1) * width + u;
      const int level = v * width + u;
      const int below = (v + 1) * width + u;
      const I nw = image[above - 1], n = image[above], ne = image[above + 1];
      const I w = image[level - 1], e = image[level + 1];
      const I sw = image[below - 1], s = image[below], se = image[below + 1];
      const I gx = (ne - nw) + ((e - w) << 1) + (se - sw);
      const I gy = (sw - nw) + ((s - n) << 1) + (se - ne);
      a += gx * gx;
      b += gy * gy;
      c += gx * gy;
    }
  return response_of_sums<P>(a, b, c);
}

}  // namespace leviosim::vio
