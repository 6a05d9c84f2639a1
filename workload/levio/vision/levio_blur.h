// The 5×5 blur as the released program has it (PARAMETERS.md#feature-extraction): 25 taps whose
// weights the compiler knows. What it computes is that of workload/vision/blur.h.
#pragma once

#include "workload/vision/blur.h"

namespace leviosim::vio::levio {

/// One pixel; coordinates outside of the image are those of the nearest pixel inside.
template <class P>
typename P::I32 blur_pixel_at_edge(ConstImageView<P> image, int x, int y) {
  using I = typename P::I32;
  const typename P::Function function("levio_blur_at_edge");
  const I last_column = image.width - 1;
  // Rows are counted from the first one that is there.
  const I first_row = -image.top;
  const I last_row = image.height - 1 - image.top;
  constexpr int kBinomial[kBlurSize] = {1, 4, 6, 4, 1};
  I sum = 0;
  for (int i = 0; i < kBlurSize; ++i) {
    const I v = work::max(first_row, work::min(last_row, I(y - image.top + i - kBlurRadius)));
    const I row = v * I(image.width);
    for (int j = 0; j < kBlurSize; ++j) {
      const I u = work::max(I(0), work::min(last_column, I(x + j - kBlurRadius)));
      sum += I(kBinomial[i] * kBinomial[j]) * I(image.pixels[I(row + u)]);
    }
  }
  return sum >> kBlurShift;
}

/// One pixel whose window lies inside the image; `corner` is the index of the window's first pixel.
template <class P>
typename P::I32 blur_pixel_inside(typename P::template Span<const typename P::Byte> image,
                                  int width, int corner) {
  using I = typename P::I32;
  constexpr int kBinomial[kBlurSize] = {1, 4, 6, 4, 1};
  I sum = 0;
  for (int i = 0; i < kBlurSize; ++i)
    for (int j = 0; j < kBlurSize; ++j)
      sum += I(kBinomial[i] * kBinomial[j]) * I(image[corner + i * width + j]);
  return sum >> kBlurShift;
}

/// Blurs the rows [begin, end) of `image`, of which those around them are there, into `blurred`.
template <class P>
void blur_rows(ConstImageView<P> image, ImageView<P> blurred, int begin, int end) {
  using Byte = typename P::Byte;
  const int width = image.width;
  const auto inside = [](int at, int size) { return at >= kBlurRadius && at < size - kBlurRadius; };
  for (int y : P::range(begin, end)) {
    // A visit is a row, so that cores with fewer rows, or with other ones, visit as much less of
    // it.
    const typename P::Code code("levio_blur_row");
    for (int x : P::range(0, width)) {
      const int corner = (y - image.top - kBlurRadius) * width + x - kBlurRadius;
      const bool whole = inside(y, image.height) && inside(x, width);
      blurred.pixels[(y - blurred.top) * width + x] =
          work::narrow<Byte>(whole ? blur_pixel_inside<P>(image.pixels, width, corner)
                                   : blur_pixel_at_edge<P>(image, x, y));
    }
  }
}

}  // namespace leviosim::vio::levio
