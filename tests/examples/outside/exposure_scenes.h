// What leviosim-measure runs: the kernel on rows such as it gets.
#pragma once

#include "exposure_kernel.h"

// [scenes]
template <class P>
void scenes() {
  using Byte = typename P::Byte;
  using Row = typename P::template Span<const Byte>;
  constexpr int kWidth = 160, kRows = 40;
  static Byte pixels[kWidth * kRows];
  for (int i = 0; i < kWidth * kRows; ++i) pixels[i] = static_cast<Byte>(i * 31 % 251);
  // Volatile: what compilers know of inputs and results they would compute beforehand, or not at all.
  Byte* volatile image = pixels;
  volatile int sums[kRows];
  const Byte* const rows = image;
  const typename P::Function scene("scene: exposure");  // what is measured, as long as it lives
  for (int y = 0; y < kRows; ++y)
    sums[y] = leviosim::work::value(exposure::row_sum<P>(Row(rows + y * kWidth, kWidth)));
}
// [/scenes]
