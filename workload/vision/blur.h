// 5×5 binomial blur of a whole image into a second buffer, before descriptors compare its pixels.
//
// As in the released embedded code (PARAMETERS.md#feature-extraction) the separable kernel (1 4 6 4
// 1) ⊗ (1 4 6 4 1) is applied as 25 taps whose weights add up to 256; the sum is divided by 256,
// rounding down. Where the window leaves the image, the nearest pixel of the image stands in
// (replicated border).
#pragma once

#include <array>

#include "workload/vision/features.h"

namespace leviosim::vio {

inline constexpr int kBlurRadius = 2;
inline constexpr int kBlurSize = 2 * kBlurRadius + 1;
inline constexpr int kBlurTaps = kBlurSize * kBlurSize;
/// Binary logarithm of the sum of the weights.
inline constexpr int kBlurShift = 8;

template <class P>
constexpr std::array<typename P::I32, kBlurTaps> make_blur_kernel() {
  constexpr std::array<int, kBlurSize> kBinomial = {1, 4, 6, 4, 1};
  std::array<typename P::I32, kBlurTaps> kernel{};
  for (int i = 0; i < kBlurSize; ++i)
    for (int j = 0; j < kBlurSize; ++j)
      kernel[i * kBlurSize + j] = typename P::I32(kBinomial[i] * kBinomial[j]);
  return kernel;
}

/// The weights, row by row, as a constant of the program image.
template <class P>
inline constexpr auto kBlurKernel = make_blur_kernel<P>();

/// One pixel whose window lies inside the image; `corner` is the index of the window's first pixel.
template <class P>
typename P::I32 blur_inside(typename P::template Span<const typename P::Byte> image, int width,
                            int corner, typename P::template Span<const typename P::I32> kernel) {
  using I = typename P::I32;
  I sum = 0;
  for (int i : P::range(0, kBlurSize))
    for (int j : P::range(0, kBlurSize))
      sum += kernel[i * kBlurSize + j] * I(image[corner + i * width + j]);
  return sum >> kBlurShift;
}

/// One pixel whose window leaves the image.
template <class P>
typename P::I32 blur_at_edge(ConstImageView<P> image, int x, int y,
                             typename P::template Span<const typename P::I32> kernel) {
  using I = typename P::I32;
  const typename P::Function function("blur_at_edge");
  const I last_column = image.width - 1;
  const I last_row = image.height - 1;
  const int rows_above = image.top * image.width;
  I sum = 0;
  for (int i : P::range(0, kBlurSize)) {
    const I v = work::max(I(0), work::min(last_row, I(y + i - kBlurRadius)));
    const I row = v * I(image.width);
    for (int j : P::range(0, kBlurSize)) {
      const I u = work::max(I(0), work::min(last_column, I(x + j - kBlurRadius)));
      sum += kernel[i * kBlurSize + j] * I(image.pixels[I(work::value(I(row + u)) - rows_above)]);
    }
  }
  return sum >> kBlurShift;
}

/// Blurs the rows [begin, end) of `image` into `blurred`, which is of the same size and must not
/// overlap it. Of `image` the rows within kBlurRadius of them must be there, of `blurred` they
/// themselves. `kernel`: kBlurKernel, in the memory of the core.
template <class P>
void blur_rows(ConstImageView<P> image, ImageView<P> blurred, int begin, int end,
               typename P::template Span<const typename P::I32> kernel) {
  using Byte = typename P::Byte;
  using I = typename P::I32;
  const int width = image.width;
  for (int y : P::range(begin, end)) {
    const int to_row = (y - blurred.top) * width;
    const auto blur_edge = [&](int from, int to) {
      for (int x : P::range(from, to))
        blurred.pixels[to_row + x] = work::narrow<Byte>(blur_at_edge<P>(image, x, y, kernel));
    };
    if (I(y) < I(kBlurRadius) || I(y) >= I(image.height - kBlurRadius) || I(width) < I(kBlurSize)) {
      blur_edge(0, width);
      continue;
    }
    blur_edge(0, kBlurRadius);
    const int first_corner = (y - image.top - kBlurRadius) * width - kBlurRadius;
    for (int x : P::range(kBlurRadius, width - kBlurRadius))
      blurred.pixels[to_row + x] =
          work::narrow<Byte>(blur_inside<P>(image.pixels, width, first_corner + x, kernel));
    blur_edge(width - kBlurRadius, width);
  }
}

}  // namespace leviosim::vio
