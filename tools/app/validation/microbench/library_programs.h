// The kernels of a public library for which cycles are published (FACTS.md#published-kernels),
// written as its page describes them: 2x2 and 4x2 blocks of matrix products, a convolution that
// keeps four results and a window of the input in registers, a dot product. All data lie in L1
// unless said.
//
// They are code that was scheduled by hand, so they say what else their authors decided: addresses
// that are computed (subspan at an I32) or kept in one more register, sums that begin with zero,
// the window that moves on (copied). What only their compiled code tells is left out: spills, and
// addresses that the compiler computed anew.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sim/work/packed.h"
#include "tools/app/validation/microbench/bench.h"

namespace leviosim::tools {

/// Sums that begin with zero.
template <class I32, int Rows, int Columns>
struct Sums {
  Sums() {
    for (auto& row : of)
      for (I32& sum : row) sum = work::copied(I32(0));
  }
  I32 of[Rows][Columns];
};

/// c = a b of n x n integers. Columns of 2x2 blocks are dealt to the cores in turn.
template <class P>
void multiply_int32(In<P, typename P::I32> a, In<P, typename P::I32> b, Out<P, typename P::I32> c,
                    int n, const work::Core& core) {
  using I32 = typename P::I32;
  const typename P::Function function("multiply_int32");
  const int columns = (n / 2 - core.id + core.cores - 1) / core.cores;
  I32 column_at = work::copied(I32(2 * core.id));
  for ([[maybe_unused]] const int column : P::range(0, columns)) {
    I32 left_at = work::copied(I32(0));
    I32 sums_at = work::copied(column_at);
    for ([[maybe_unused]] const int row : P::range(0, n / 2)) {
      const auto upper = a.subspan(left_at, n);
      const auto lower = a.subspan(left_at + I32(n), n);
      const auto right = b.subspan(work::copied(column_at), (n - 1) * n + 2);
      Sums<I32, 2, 2> sums;
      for (const int k : P::range(0, n)) {
        const I32 left[2] = {upper[k], lower[k]};
        const I32 beside[2] = {right[k * n], right[k * n + 1]};
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j) sums.of[i][j] += left[i] * beside[j];
      }
      const auto first = c.subspan(sums_at, 2);
      const auto second = c.subspan(sums_at + I32(n), 2);
      for (int j = 0; j < 2; ++j) first[j] = sums.of[0][j];
      for (int j = 0; j < 2; ++j) second[j] = sums.of[1][j];
      left_at += I32(2 * n);
      sums_at += I32(2 * n);
    }
    column_at += I32(2 * core.cores);
  }
}

/// The same of pairs of 16 bits in blocks of 4x2, sums of 32 bits: a and b are words, row by row.
template <class P>
void multiply_int16(In<P, work::I16x2<P>> a, In<P, work::I16x2<P>> b, Out<P, typename P::I32> c,
                    int n, const work::Core& core) {
  using I32 = typename P::I32;
  using Pair = work::I16x2<P>;
  const typename P::Function function("multiply_int16");
  const int words = n / 2;
  const int columns = (words - core.id + core.cores - 1) / core.cores;
  I32 column_at = work::copied(I32(core.id));
  for ([[maybe_unused]] const int column : P::range(0, columns)) {
    I32 left_at = work::copied(I32(0));
    I32 sums_at = column_at + column_at;
    for ([[maybe_unused]] const int row : P::range(0, n / 4)) {
      In<P, Pair> rows[4];
      I32 row_at = left_at;
      for (int i = 0; i < 4; ++i) {
        if (i > 0) row_at += I32(words);
        rows[i] = a.subspan(row_at, words);
      }
      const auto even = b.subspan(work::copied(column_at), (n - 2) * words + 1);
      const auto odd = b.subspan(column_at + I32(words), (n - 2) * words + 1);
      Sums<I32, 4, 2> sums;
      for (const int k : P::range(0, words)) {
        Pair left[4];
        for (int i = 0; i < 4; ++i) left[i] = rows[i][k];
        const Pair upper = even[2 * k * words];
        const Pair lower = odd[2 * k * words];
        const Pair right[2] = {work::select<0, 2>(upper, lower), work::select<1, 3>(upper, lower)};
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 2; ++j) sums.of[i][j] = dot(left[i], right[j], sums.of[i][j]);
      }
      I32 result_at = sums_at;
      for (int i = 0; i < 4; ++i) {
        if (i > 0) result_at += I32(n);
        const auto results = c.subspan(result_at, 2);
        for (int j = 0; j < 2; ++j) results[j] = sums.of[i][j];
      }
      left_at += I32(4 * words);
      sums_at += I32(4 * n);
    }
    column_at += I32(core.cores);
  }
}

/// out[t] = sum of x[t - j] taps[j]: the full convolution. Four results at a time: what the four
/// have in common in steps of four taps, and the rest of each by itself.
template <class P>
void convolve_int32(In<P, typename P::I32> x, In<P, typename P::I32> taps,
                    Out<P, typename P::I32> out) {
  using I32 = typename P::I32;
  const typename P::Function function("convolve_int32");
  const int n = x.size();
  const int m = taps.size();
  for (const int block : P::range(0, (n + m + 2) / 4)) {
    const int t = 4 * block;
    Sums<I32, 1, 4> block_sums;
    I32(&sums)[4] = block_sums.of[0];
    // Taps for which all four results lie over x: t + 3 - n < j <= t.
    const int first = std::max(0, t + 4 - n);
    const int end = std::min(m, t + 1);
    const int steps = std::max(0, end - first) / 4;
    const int last = 4 * steps - 1;  // value that the first step begins with, of those below
    if (steps > 0) {
      const auto values = x.subspan(work::copied(I32(t - first - last)), last + 4);
      const auto some_taps = taps.subspan(work::copied(I32(first)), last + 1);
      I32 window[7];
      for (int i = 0; i < 3; ++i) window[4 + i] = values[last + 1 + i];
      for (const int step : P::range(0, steps)) {
        for (int i = 0; i < 4; ++i) window[3 - i] = values[last - 4 * step - i];
        for (int k = 0; k < 4; ++k) {
          const I32 tap = some_taps[4 * step + k];
          for (int i = 0; i < 4; ++i) sums[i] += window[3 + i - k] * tap;
        }
        for (int i = 0; i < 3; ++i) window[4 + i] = work::copied(window[i]);
      }
    }
    for (int i = 0; i < 4; ++i) {
      const int least = std::max(0, t + i + 1 - n);
      const int most = std::min(m, t + i + 1);
      const auto edge = [&](int from, int to) {
        if (from >= to) return;
        const auto values = x.subspan(work::copied(I32(t + i - to + 1)), to - from);
        const auto some_taps = taps.subspan(work::copied(I32(from)), to - from);
        for (const int j : P::range(0, to - from))
          sums[i] += values[to - from - 1 - j] * some_taps[j];
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
  const typename P::Function function("dot_int32");
  const auto left = a.subspan(work::copied(I32(begin)), end - begin);
  const auto right = b.subspan(work::copied(I32(begin)), end - begin);
  I32 sum = work::copied(I32(0));
  for (const int i : P::range(0, (end - begin) / 2)) {
    sum += I32(left[2 * i]) * I32(right[2 * i]);
    sum += I32(left[2 * i + 1]) * I32(right[2 * i + 1]);
  }
  return sum;
}

}  // namespace leviosim::tools
