// FAST and Harris as the released program evaluates them (PARAMETERS.md#feature-extraction): FAST
// fills two arrays with what is brighter and darker, and forms the lengths of runs by products,
// without early exit. What they compute is that of workload/vision/fast.h and harris.h.
#pragma once

#include "workload/levio/vision/offset_tables.h"
#include "workload/math/compilers.h"
#include "workload/math/target_compiler.h"
#include "workload/vision/fast.h"
#include "workload/vision/harris.h"

namespace leviosim::vio::levio {

/// Whether the pixel at index `centre` is a corner; the ring must lie inside the image.
/// @param threshold  grey levels, strictly exceeded
template <class P>
LEVIOSIM_HOST_INLINE typename P::Bool is_corner(
    typename P::template Span<const typename P::Byte> image, int centre,
    const OffsetTables<P>& tables, typename P::I32 threshold) {
  using Byte = typename P::Byte;
  using I = typename P::I32;
  using U = typename P::U32;
  const typename P::Code code("levio_is_corner");
  const auto offsets = tables.ring();
  const I level = image[centre];
  const I upper = level + threshold;
  const I lower = level - threshold;
  typename P::template Array<Byte, kRingSize> brighter, darker;
  for (int k : P::range(0, kRingSize)) {
    const I pixel = image[I(offsets[k] + I(centre))];
    // The sign of a difference is the outcome of the comparison.
    brighter[k] = work::narrow<Byte>(I(U(I(upper - pixel)) >> 31));
    darker[k] = work::narrow<Byte>(I(U(I(pixel - lower)) >> 31));
  }
  I bright_run = 0;
  I dark_run = 0;
  I longest = 0;
  const auto extend_runs = [&](int k) {
    bright_run = (bright_run + I(1)) * I(brighter[k]);
    dark_run = (dark_run + I(1)) * I(darker[k]);
    longest = work::max(longest, work::max(bright_run, dark_run));
  };
  LEVIOSIM_ROLLED
  for (int k : P::range(0, kRingSize)) extend_runs(k);
  LEVIOSIM_ROLLED
  for (int k : P::range(0, kFastArc - 1)) extend_runs(k);
  return longest >= I(kFastArc);
}

/// Response at index `centre`; the window and its gradients must lie inside the image.
template <class P>
LEVIOSIM_HOST_INLINE LEVIOSIM_TARGET_CALL typename P::I32 corner_response(
    typename P::template Span<const typename P::Byte> image, int width, int centre,
    const OffsetTables<P>& tables) {
  using I = typename P::I32;
  const typename P::Function function("levio_corner_response");
  const auto offsets = tables.harris();
  I a = 0;  // sum of gx²
  I b = 0;  // sum of gy²
  I c = 0;  // sum of gx gy
  for (int k : P::range(0, kHarrisPixels)) {
    const I at = offsets[k] + I(centre);
    const auto rows = image.subspan(I(at - I(width + 1)), 2 * width + 3);
    const I nw = rows[0], n = rows[1], ne = rows[2];
    const I w = rows[width], e = rows[width + 2];
    const I sw = rows[2 * width], s = rows[2 * width + 1], se = rows[2 * width + 2];
    const I gx = (ne - nw) + ((e - w) << 1) + (se - sw);
    const I gy = (sw - nw) + ((s - n) << 1) + (se - ne);
    a += gx * gx;
    b += gy * gy;
    c += gx * gy;
  }
  return response_of_sums<P>(a, b, c);
}

}  // namespace leviosim::vio::levio
