// The kernels of the optical flow: how much texture a block has, where it went, and by how many
// half pixels. All work on rows of bytes, four at a time, which lie at any address: words that
// cross a word of the memory count as such.
//
// Differences are sums of absolute differences (SAD) of grey levels. Left out: an early end of a
// sum that has become too large (the published code has none), and blocks of other sizes.
#pragma once

#include <utility>

#include "sim/work/packed.h"
#include "sim/work/policy.h"
#include "workload/flow/options.h"

namespace leviosim::flow {

template <class P>
using Word = work::U8x4<P>;

/// A square image in words of four pixels, row by row.
template <class P>
struct Image {
  typename P::template Span<const Word<P>> words;
  int side = 0;  ///< px

  /// Words between a pixel and the one below.
  int pitch() const { return side / 4; }
  /// The words from a pixel on, pixel (x, y) being number y * side + x.
  typename P::template Span<const Word<P>> from(int pixel) const {
    return work::from_byte(words, pixel);
  }
};

/// Differences between neighbours in the four rows and columns in the middle of the block whose
/// first pixel this is: 16 with the right one and 16 with the one below.
template <class P>
typename P::I32 texture(const Image<P>& image, int block) {
  using I = typename P::I32;
  constexpr int kToMiddle = kBlock / 2 - 2;
  const int middle = block + kToMiddle * image.side + kToMiddle;
  const auto at = image.from(middle);
  const auto right = image.from(middle + 1);
  I sum = 0;
  Word<P> above = at[0];
  for (int row : P::range(0, 4)) {
    const Word<P> next = at[(row + 1) * image.pitch()];
    const Word<P> beside = right[row * image.pitch()];
    sum = add_differences(above, beside, sum);
    sum = add_differences(above, next, sum);
    above = next;
  }
  return sum;
}

/// Difference of two blocks: 16 words of either, the loop over them unrolled, as in the published
/// code.
template <class P, int... Row>
typename P::I32 block_difference(typename P::template Span<const Word<P>> a,
                                 typename P::template Span<const Word<P>> b, int pitch,
                                 std::integer_sequence<int, Row...>) {
  typename P::I32 sum = 0;
  const auto add = [&](int i) {
    const Word<P> x = a[i];
    const Word<P> y = b[i];
    sum = add_differences(x, y, sum);
  };
  ((add(Row * pitch), add(Row * pitch + 1)), ...);
  return sum;
}

/// Where a block fits best, and how well.
template <class P>
struct Candidate {
  typename P::I32 number, difference;
};

/// The best of `candidates` blocks of `now` in a row, from pixel `first` on; the first of equals.
template <class P>
Candidate<P> best_in_row(const Image<P>& before, int block, const Image<P>& now, int first,
                         int candidates) {
  using I = typename P::I32;
  const auto wanted = before.from(block);
  Candidate<P> best{0, 0x7fffffff};
  for (int k : P::range(0, candidates)) {
    const I difference = block_difference<P>(wanted, now.from(first + k), now.pitch(),
                                             std::make_integer_sequence<int, kBlock>());
    if (difference < best.difference) best = {k, difference};
  }
  return best;
}

/// Differences at the eight half-pixel positions around a match.
template <class P>
struct HalfPixelDifferences {
  using I = typename P::I32;
  I north_west = 0, north = 0, north_east = 0;
  I west = 0, east = 0;
  I south_west = 0, south = 0, south_east = 0;
};

/// Four pixels of a row, and the means with their left and right neighbours.
template <class P>
struct RowOfMeans {
  Word<P> centre, left, right;
};

template <class P>
RowOfMeans<P> row_of_means(const Image<P>& image, int pixel) {
  const Word<P> centre = image.from(pixel)[0];
  const Word<P> left = image.from(pixel - 1)[0];
  const Word<P> right = image.from(pixel + 1)[0];
  return {centre, average(centre, left), average(centre, right)};
}

/// Between two rows.
template <class P>
RowOfMeans<P> average(const RowOfMeans<P>& a, const RowOfMeans<P>& b) {
  return {average(a.centre, b.centre), average(a.left, b.left), average(a.right, b.right)};
}

/// Of the block `wanted` to `now` half a pixel around `match`. Between two pixels stands their
/// mean, among four the mean of the two means in rows; each is rounded down.
template <class P>
HalfPixelDifferences<P> half_pixel_differences(const Image<P>& before, int wanted,
                                               const Image<P>& now, int match) {
  HalfPixelDifferences<P> sum;
  const auto add_rows = [](const Word<P>& word, const RowOfMeans<P>& row, auto& left, auto& middle,
                           auto& right) {
    left = add_differences(word, row.left, left);
    middle = add_differences(word, row.centre, middle);
    right = add_differences(word, row.right, right);
  };
  for (const int column : {0, 4}) {
    RowOfMeans<P> above = row_of_means<P>(now, match + column - now.side);
    RowOfMeans<P> here = row_of_means<P>(now, match + column);
    RowOfMeans<P> between = average(above, here);
    for (int row : P::range(0, kBlock)) {
      const Word<P> word = before.from(wanted + row * before.side + column)[0];
      add_rows(word, between, sum.north_west, sum.north, sum.north_east);
      sum.west = add_differences(word, here.left, sum.west);
      sum.east = add_differences(word, here.right, sum.east);
      const RowOfMeans<P> below = row_of_means<P>(now, match + column + (row + 1) * now.side);
      between = average(here, below);
      add_rows(word, between, sum.south_west, sum.south, sum.south_east);
      here = below;
    }
  }
  return sum;
}

/// A displacement in half pixels.
template <class P>
struct HalfPixels {
  typename P::I32 x, y;
};

/// The best of the eight positions if it is better than the match itself, else none: (0, 0).
template <class P>
HalfPixels<P> best_half_pixel(const HalfPixelDifferences<P>& at, typename P::I32 of_match) {
  HalfPixels<P> best{0, 0};
  typename P::I32 least = of_match;
  const auto consider = [&](typename P::I32 difference, int x, int y) {
    if (difference < least) {
      least = difference;
      best = {x, y};
    }
  };
  consider(at.west, -1, 0);
  consider(at.east, 1, 0);
  consider(at.north, 0, -1);
  consider(at.south, 0, 1);
  consider(at.north_west, -1, -1);
  consider(at.north_east, 1, -1);
  consider(at.south_west, -1, 1);
  consider(at.south_east, 1, 1);
  return best;
}

}  // namespace leviosim::flow
