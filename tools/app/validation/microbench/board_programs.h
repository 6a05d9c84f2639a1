// The kernels that the vendor measured on a GAP8 board
// (tools/app/validation/published/gap8_board.csv), written as a programmer of that board would:
// each core takes a share of the rows, columns or outputs, all data lie in L1.
//
// The source does not state the data types. Scalar kernels work on 16-bit values here (8-bit ones
// cost the same loads). SIMD kernels: pairs of 16 bits for the 2×2 pools, since a window is two
// pairs; four bytes for the layers, since two loads and a product of pairs cannot be done in the
// 0.9 (linear) and 0.6 (convolution) cycles per product that were measured.
//
// Loops of constant length 5 and 25 are unrolled by the compiler: plain loops, which count nothing.
#pragma once

#include <cstdint>

#include "sim/work/packed.h"
#include "tools/app/validation/microbench/bench.h"

namespace leviosim::tools {

/// Scalar values in the memory of the kernels.
using Sample = std::int16_t;

constexpr int kPoolSize = 112;  ///< side of the image that is pooled and convolved
constexpr int kPooled = kPoolSize / 2;
constexpr int kWindow = 5;  ///< side of the convolutions
constexpr int kConvolved = kPoolSize - kWindow + 1;
constexpr int kInputs = 1024;  ///< of the linear layer
constexpr int kOutputs = 16;
constexpr int kBinarySize = 100;  ///< side of the binary image
constexpr int kBinaryWords = 4;   ///< of 32 pixels, per row
constexpr int kBinaryOut = kBinarySize - kWindow + 1;
constexpr int kNorm = 8;  ///< fraction bits of coefficients

/// ---- 2×2 pools: image 112×112 → 56×56, rows [share) of the output ----
template <class P>
void max_pool(In<P, Sample> in, Out<P, Sample> out, work::Share rows) {
  using I32 = typename P::I32;
  for (const int y : P::range(rows.begin, rows.end))
    for (const int x : P::range(0, kPooled)) {
      const int at = 2 * y * kPoolSize + 2 * x;
      const I32 upper = work::max(I32(in[at]), I32(in[at + 1]));
      const I32 lower = work::max(I32(in[at + kPoolSize]), I32(in[at + kPoolSize + 1]));
      out[y * kPooled + x] = work::narrow<Sample>(work::max(upper, lower));
    }
}

template <class P>
void average_pool(In<P, Sample> in, Out<P, Sample> out, work::Share rows) {
  using I32 = typename P::I32;
  for (const int y : P::range(rows.begin, rows.end))
    for (const int x : P::range(0, kPooled)) {
      const int at = 2 * y * kPoolSize + 2 * x;
      const I32 upper = I32(in[at]) + I32(in[at + 1]);
      const I32 three = upper + I32(in[at + kPoolSize]);
      const I32 mean = work::add_shifted(three, I32(in[at + kPoolSize + 1]), 2);
      out[y * kPooled + x] = work::narrow<Sample>(mean);
    }
}

template <class P>
void max_pool_simd(In<P, work::I16x2<P>> in, Out<P, Sample> out, work::Share rows) {
  using Pair = work::I16x2<P>;
  for (const int y : P::range(rows.begin, rows.end))
    for (const int x : P::range(0, kPooled)) {
      const Pair columns = max(Pair(in[2 * y * kPooled + x]), Pair(in[(2 * y + 1) * kPooled + x]));
      out[y * kPooled + x] = work::narrow<Sample>(work::max(columns.lane(0), columns.lane(1)));
    }
}

template <class P>
void average_pool_simd(In<P, work::I16x2<P>> in, Out<P, Sample> out, work::Share rows) {
  using Pair = work::I16x2<P>;
  const Pair ones = work::splat<Pair>(1);
  for (const int y : P::range(rows.begin, rows.end))
    for (const int x : P::range(0, kPooled)) {
      const auto upper = dot(Pair(in[2 * y * kPooled + x]), ones);
      const auto sum = dot(Pair(in[(2 * y + 1) * kPooled + x]), ones, upper);
      out[y * kPooled + x] = work::narrow<Sample>(sum >> 2);
    }
}

/// ---- 5×5 convolution: image 112×112 → 108×108 ----
template <class P>
void convolve(In<P, Sample> in, In<P, Sample> kernel, Out<P, Sample> out, work::Share rows) {
  using I32 = typename P::I32;
  for (const int y : P::range(rows.begin, rows.end))
    for (const int x : P::range(0, kConvolved)) {
      I32 sum = 0;
      for (int v = 0; v < kWindow; ++v)
        for (int u = 0; u < kWindow; ++u)
          sum += I32(in[(y + v) * kPoolSize + x + u]) * I32(kernel[v * kWindow + u]);
      out[y * kConvolved + x] = work::narrow<Sample>(sum >> kNorm);
    }
}

/// A window slides down a column. A row of it is a word and one more byte; the bytes of the four
/// upper rows that do not fit make up a word of their own (`fifth`), the last one is the `corner`.
/// @param kernel  words: five rows, the fifth column, the corner with zeros
template <class P>
void convolve_simd(In<P, work::I8x4<P>> in, In<P, work::I8x4<P>> kernel, Out<P, Sample> out,
                   work::Share columns) {
  using I32 = typename P::I32;
  using Bytes = work::I8x4<P>;
  constexpr int kPitch = kPoolSize / 4;
  constexpr int kLast = kWindow - 1;
  Bytes weights[kWindow + 2];
  for (int v = 0; v < kWindow + 2; ++v) weights[v] = kernel[v];
  for (const int x : P::range(columns.begin, columns.end)) {
    const In<P, Bytes> words = work::from_byte(in, x);
    const auto beside = work::bytes_of<P>(in, x + 4);
    Bytes row[kWindow];
    Bytes fifth = work::splat<Bytes>(0);
    for (int v = 0; v < kLast; ++v) {
      row[v] = words[v * kPitch];
      fifth = work::select<1, 2, 3, 4>(fifth, Bytes::of_register(I32(beside[v * kPoolSize])));
    }
    for (const int y : P::range(0, kConvolved)) {
      row[kLast] = words[(y + kLast) * kPitch];
      const Bytes corner = Bytes::of_register(I32(beside[(y + kLast) * kPoolSize]));
      I32 sum = dot(fifth, weights[kWindow]);
      sum = dot(corner, weights[kWindow + 1], sum);
      for (int v = 0; v < kWindow; ++v) sum = dot(row[v], weights[v], sum);
      for (int v = 0; v < kLast; ++v) row[v] = row[v + 1];
      fifth = work::select<1, 2, 3, 4>(fifth, corner);
      out[y * kConvolved + x] = work::narrow<Sample>(sum >> kNorm);
    }
  }
}

/// ---- linear layer 1024 → 16, outputs [share) ----
template <class P>
void linear(In<P, Sample> in, In<P, Sample> weights, Out<P, Sample> out, work::Share outputs) {
  using I32 = typename P::I32;
  for (const int o : P::range(outputs.begin, outputs.end)) {
    I32 sum = 0;
    for (const int i : P::range(0, kInputs)) sum += I32(in[i]) * I32(weights[o * kInputs + i]);
    out[o] = work::narrow<Sample>(sum >> kNorm);
  }
}

template <class P>
void linear_simd(In<P, work::I8x4<P>> in, In<P, work::I8x4<P>> weights, Out<P, Sample> out,
                 work::Share outputs) {
  using I32 = typename P::I32;
  using Bytes = work::I8x4<P>;
  for (const int o : P::range(outputs.begin, outputs.end)) {
    I32 sum = 0;
    for (const int i : P::range(0, kInputs / 4))
      sum = dot(Bytes(in[i]), Bytes(weights[o * (kInputs / 4) + i]), sum);
    out[o] = work::narrow<Sample>(sum >> kNorm);
  }
}

/// ---- 5×5 convolution of a binary image 100×100, 32 pixels a word: +1 per equal pixel, -1 per
/// other one, added to the output 96×96 ----
/// @param filter  25 bits, row by row
template <class P>
void xnor_convolve(In<P, typename P::U32> in, typename P::U32 filter, Out<P, Sample> out,
                   work::Share columns) {
  using I32 = typename P::I32;
  using U32 = typename P::U32;
  const U32 row_mask = (1U << kWindow) - 1;
  const U32 mask = (1U << kWindow * kWindow) - 1;
  const U32 inverted = ~filter & mask;
  for (const int x : P::range(columns.begin, columns.end)) {
    const int word = x / 32;
    const int shift = x % 32;
    const auto pixels = [&](int y) {
      U32 bits = U32(in[y * kBinaryWords + word]) >> shift;
      if (shift + kWindow > 32) bits |= U32(in[y * kBinaryWords + word + 1]) << (32 - shift);
      return bits & row_mask;
    };
    U32 window = 0;
    for (int y = 0; y < kWindow - 1; ++y) window = (window << kWindow) | pixels(y);
    for (const int y : P::range(0, kBinaryOut)) {
      window = ((window << kWindow) | pixels(y + kWindow - 1)) & mask;
      const I32 equal = work::popcount(window ^ inverted);
      const I32 before = out[y * kBinaryOut + x];
      out[y * kBinaryOut + x] =
          work::narrow<Sample>(before + ((equal << 1) - I32(kWindow * kWindow)));
    }
  }
}

}  // namespace leviosim::tools
