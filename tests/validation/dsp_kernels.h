// The kernels of a public library for which cycles are published (FACTS.md#published-kernels),
// written as its page describes them: 2x2 and 4x2 blocks of matrix products, a convolution that
// keeps four results and a window of the input in registers, a dot product. All data lie in L1
// unless said.
//
// Register moves (the window's) are what compilers add, as everywhere in counted work.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sim/work/machine.h"
#include "sim/work/packed.h"

namespace leviosim::tools {

template <class P, class T>
using In = typename P::template Span<const T>;
template <class P, class T>
using Out = typename P::template Span<T>;

/// c = a b of n x n integers. Columns of 2x2 blocks are dealt to the cores in turn.
template <class P>
void multiply_int32(In<P, typename P::I32> a, In<P, typename P::I32> b, Out<P, typename P::I32> c,
                    int n, const work::Core& core) {
  using I32 = typename P::I32;
  const int columns = (n / 2 - core.id + core.cores - 1) / core.cores;
  for (const int column : P::range(0, columns)) {
    const int x = 2 * (core.id + core.cores * column);
    for (const int row : P::range(0, n / 2)) {
      const int y = 2 * row;
      I32 sums[2][2] = {{0, 0}, {0, 0}};
      for (const int k : P::range(0, n)) {
        const I32 left[2] = {a[y * n + k], a[(y + 1) * n + k]};
        const I32 right[2] = {b[k * n + x], b[k * n + x + 1]};
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j) sums[i][j] += left[i] * right[j];
      }
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) c[(y + i) * n + x + j] = sums[i][j];
    }
  }
}

/// The same of pairs of 16 bits in blocks of 4x2, sums of 32 bits: a and b are words, row by row.
template <class P>
void multiply_int16(In<P, work::I16x2<P>> a, In<P, work::I16x2<P>> b, Out<P, typename P::I32> c,
                    int n, const work::Core& core) {
  using I32 = typename P::I32;
  using Pair = work::I16x2<P>;
  const int words = n / 2;
  const int columns = (words - core.id + core.cores - 1) / core.cores;
  for (const int column : P::range(0, columns)) {
    const int x = core.id + core.cores * column;
    for (const int row : P::range(0, n / 4)) {
      const int y = 4 * row;
      I32 sums[4][2] = {{0, 0}, {0, 0}, {0, 0}, {0, 0}};
      for (const int k : P::range(0, words)) {
        Pair left[4];
        for (int i = 0; i < 4; ++i) left[i] = a[(y + i) * words + k];
        const Pair upper = b[2 * k * words + x];
        const Pair lower = b[(2 * k + 1) * words + x];
        const Pair right[2] = {work::select<0, 2>(upper, lower), work::select<1, 3>(upper, lower)};
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 2; ++j) sums[i][j] = dot(left[i], right[j], sums[i][j]);
      }
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 2; ++j) c[(y + i) * n + 2 * x + j] = sums[i][j];
    }
  }
}

/// out[t] = sum of x[t - j] taps[j]: the full convolution. Four results at a time: what the four
/// have in common in steps of four taps, and the rest of each by itself.
template <class P>
void convolve_int32(In<P, typename P::I32> x, In<P, typename P::I32> taps,
                    Out<P, typename P::I32> out) {
  using I32 = typename P::I32;
  const int n = x.size();
  const int m = taps.size();
  for (const int block : P::range(0, (n + m + 2) / 4)) {
    const int t = 4 * block;
    I32 sums[4] = {0, 0, 0, 0};
    // Taps for which all four results lie over x: t + 3 - n < j <= t.
    const int first = std::max(0, t + 4 - n);
    const int end = std::min(m, t + 1);
    const int steps = std::max(0, end - first) / 4;
    I32 window[7];
    for (int i = 0; i < 3 && steps > 0; ++i) window[4 + i] = x[t + 1 - first + i];
    for (const int step : P::range(0, steps)) {
      const int j = first + 4 * step;
      for (int i = 0; i < 3; ++i) window[i + 4] = step == 0 ? window[i + 4] : window[i];
      for (int i = 0; i < 4; ++i) window[3 - i] = x[t - j - i];
      for (int k = 0; k < 4; ++k) {
        const I32 tap = taps[j + k];
        for (int i = 0; i < 4; ++i) sums[i] += window[3 + i - k] * tap;
      }
    }
    for (int i = 0; i < 4; ++i) {
      const int least = std::max(0, t + i + 1 - n);
      const int most = std::min(m, t + i + 1);
      const auto edge = [&](int from, int to) {
        if (from >= to) return;
        for (const int j : P::range(from, to)) sums[i] += x[t + i - j] * taps[j];
      };
      edge(least, std::min(first, most));
      edge(std::max(least, first + 4 * steps), most);
      if (t + i < out.size()) out[t + i] = sums[i];
    }
  }
}

/// Two elements per round.
template <class P, class Values>
typename P::I32 dot_int32(const Values& a, const Values& b, int begin, int end) {
  using I32 = typename P::I32;
  I32 sum = 0;
  for (const int i : P::range(begin / 2, end / 2)) {
    sum += I32(a[2 * i]) * I32(b[2 * i]);
    sum += I32(a[2 * i + 1]) * I32(b[2 * i + 1]);
  }
  return sum;
}

}  // namespace leviosim::tools
