// The offsets of pixels that the released program reads from tables (PARAMETERS.md#memory): the
// tables lie in local memory, the pointers to them in L2, and a pointer is read at every use.
#pragma once

#include <array>

#include "workload/vision/fast.h"

namespace leviosim::vio::levio {

inline constexpr int kHarrisWindow = 7;
inline constexpr int kHarrisPixels = kHarrisWindow * kHarrisWindow;

/// Offsets from a centre, for images of one width.
template <class P>
class OffsetTables {
  using I = typename P::I32;
  using Table = typename P::template Span<I>;

 public:
  static constexpr int kIntegers = kRingSize + kHarrisPixels;

  OffsetTables(work::Arena& arena, int image_width)
      : offsets_(arena.alloc<Table>("FAST and Harris offsets", kIntegers)) {
    fill_ring_offsets<P>(image_width, offsets_.subspan(0, kRingSize));
    const int radius = kHarrisWindow / 2;
    int at = kRingSize;
    for (int v : P::range(-radius, radius + 1))
      for (int u : P::range(-radius, radius + 1)) offsets_[at++] = I(v) * I(image_width) + I(u);
  }

  Table ring() const { return offsets_.subspan(I(pointers()[0]), kRingSize); }
  Table harris() const { return offsets_.subspan(I(pointers()[1]), kHarrisPixels); }

 private:
  typename P::template L2Span<const I> pointers() const { return {pointers_.data(), 2}; }

  Table offsets_;
  std::array<I, 2> pointers_{I(0), I(kRingSize)};  ///< places in offsets_
};

}  // namespace leviosim::vio::levio
