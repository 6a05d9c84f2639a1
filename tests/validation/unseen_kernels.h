// Ten kernels of other fields than odometry, for validation: what a user of leviosim would bring.
// Five were written by somebody who knew no cost of the model, so that none is chosen for its sake.
// What they are held against stands in unseen_kernels_test.cpp.
#pragma once

#include <cstdint>

#include "sim/work/functions.h"
#include "sim/work/policy.h"
#include "sim/work/wide.h"

namespace leviosim::unseen {

/// Cascade of biquads in direct form II over a block of samples, float.
template <class P>
void biquads(typename P::template Span<const typename P::F32> in,
             typename P::template Span<typename P::F32> out,
             typename P::template Span<const typename P::F32> coefficients,
             typename P::template Span<typename P::F32> state, int n, int sections) {
  using F = typename P::F32;
  const typename P::Function function("unseen_biquads");
  for (int i : P::range(0, n)) {
    F x = in[i];
    for (int s : P::range(0, sections)) {
      const F w1 = state[2 * s], w2 = state[2 * s + 1];
      const F w = x - coefficients[5 * s + 3] * w1 - coefficients[5 * s + 4] * w2;
      x = coefficients[5 * s] * w + coefficients[5 * s + 1] * w1 + coefficients[5 * s + 2] * w2;
      state[2 * s + 1] = w1;
      state[2 * s] = w;
    }
    out[i] = x;
  }
}

/// CRC-32 of n bytes with a table of 256 words.
template <class P>
typename P::U32 crc32(typename P::template Span<const typename P::Byte> bytes,
                      typename P::template Span<const typename P::U32> table, int n) {
  using U = typename P::U32;
  using I = typename P::I32;
  const typename P::Function function("unseen_crc32");
  U crc = U(0xffffffffu);
  for (int i : P::range(0, n)) {
    const I at = I(U(crc ^ U(I(bytes[i])))) & I(255);
    crc = U(table[at]) ^ (crc >> 8);
  }
  return crc ^ U(0xffffffffu);
}

/// c = a b of n x n floats.
template <class P>
void product(typename P::template Span<const typename P::F32> a,
             typename P::template Span<const typename P::F32> b,
             typename P::template Span<typename P::F32> c, int n) {
  using F = typename P::F32;
  const typename P::Function function("unseen_product");
  for (int i : P::range(0, n))
    for (int j : P::range(0, n)) {
      F sum = 0;
      for (int k : P::range(0, n)) sum += F(a[n * i + k]) * F(b[n * k + j]);
      c[n * i + j] = sum;
    }
}

/// Median of 3 x 3 pixels at each pixel inside, by an insertion sort of the nine.
template <class P>
void median(typename P::template Span<const typename P::Byte> in,
            typename P::template Span<typename P::Byte> out, int width, int height) {
  using I = typename P::I32;
  const typename P::Function function("unseen_median");
  for (int y : P::range(1, height - 1))
    for (int x : P::range(1, width - 1)) {
      typename P::template Array<I, 9> sorted;
      int n = 0;
      for (int v = -1; v <= 1; ++v)
        for (int u = -1; u <= 1; ++u, ++n) {
          const I value = in[(y + v) * width + x + u];
          I at = n;
          while (at > I(0)) {
            const I below = sorted[at - I(1)];
            if (value >= below) break;
            sorted[at] = below;
            at -= I(1);
          }
          sorted[at] = value;
        }
      out[y * width + x] = work::narrow<typename P::Byte>(I(sorted[4]));
    }
}

/// Histogram of bytes, then the sum of each bin and all below it.
template <class P>
void histogram(typename P::template Span<const typename P::Byte> in,
               typename P::template Span<typename P::I32> bins, int n) {
  using I = typename P::I32;
  const typename P::Function function("unseen_histogram");
  for (int k : P::range(0, 256)) bins[k] = I(0);
  for (int i : P::range(0, n)) {
    const I at = in[i];
    bins[at] = I(bins[at]) + I(1);
  }
  I sum = 0;
  for (int k : P::range(0, 256)) {
    sum += I(bins[k]);
    bins[k] = sum;
  }
}

/// Complex FFT in place, decimation in time. `cosine` and `sine` hold n / 2 values of a turn's
/// first half; n is 2 to the power of `stages`.
template <class P>
void fft_radix2(typename P::template Span<typename P::F32> re,
                typename P::template Span<typename P::F32> im,
                typename P::template Span<const typename P::F32> cosine,
                typename P::template Span<const typename P::F32> sine, int n, int stages) {
  using F = typename P::F32;
  using I = typename P::I32;
  const typename P::Function function("unseen_fft_radix2");
  // Bit-reversed order: j is i, counted from the other end.
  I j = 0;
  for (int i : P::range(1, n)) {
    I bit = n >> 1;
    while ((j & bit) != 0) {
      j ^= bit;
      bit >>= 1;
    }
    j |= bit;
    if (I(i) < j) {
      const F r = re[i];
      const F m = im[i];
      re[i] = F(re[j]);
      im[i] = F(im[j]);
      re[j] = r;
      im[j] = m;
    }
  }
  int half = 1;
  int step = n / 2;
  for ([[maybe_unused]] int stage : P::range(0, stages)) {
    for (int group : P::range(0, step)) {
      const int first = group * 2 * half;
      for (int k : P::range(0, half)) {
        const F wr = cosine[k * step];
        const F wi = sine[k * step];
        const F br = re[first + half + k];
        const F bi = im[first + half + k];
        const F tr = wr * br + wi * bi;
        const F ti = wr * bi - wi * br;
        const F ar = re[first + k];
        const F ai = im[first + k];
        re[first + k] = ar + tr;
        im[first + k] = ai + ti;
        re[first + half + k] = ar - tr;
        im[first + half + k] = ai - ti;
      }
    }
    half *= 2;
    step /= 2;
  }
}

/// Solves a x = b for a symmetric positive definite n × n matrix. The lower triangle of `a` becomes
/// its Cholesky factor, `b` the solution.
template <class P>
void cholesky_solve(typename P::template Span<typename P::F32> a,
                    typename P::template Span<typename P::F32> b, int n) {
  using F = typename P::F32;
  const typename P::Function function("unseen_cholesky_solve");
  for (int j : P::range(0, n)) {
    F square = a[j * n + j];
    for (int k : P::range(0, j)) {
      const F l = a[j * n + k];
      square -= l * l;
    }
    const F diagonal = work::sqrt(square);
    a[j * n + j] = diagonal;
    for (int i : P::range(j + 1, n)) {
      F sum = a[i * n + j];
      for (int k : P::range(0, j)) sum -= F(a[i * n + k]) * F(a[j * n + k]);
      a[i * n + j] = sum / diagonal;
    }
  }
  for (int i : P::range(0, n)) {
    F sum = b[i];
    for (int k : P::range(0, i)) sum -= F(a[i * n + k]) * F(b[k]);
    b[i] = sum / F(a[i * n + i]);
  }
  for (int i : P::down_range(n - 1, 0)) {
    F sum = b[i];
    for (int k : P::range(i + 1, n)) sum -= F(a[k * n + i]) * F(b[k]);
    b[i] = sum / F(a[i * n + i]);
  }
}

/// Range decoder with a fixed model: symbol s has the frequencies from cumulative[s] to below
/// cumulative[s + 1], of cumulative[symbols] in total. Behind its end the stream is zero.
/// Returns the number of bytes read.
template <class P>
typename P::I32 range_decode(typename P::template Span<const typename P::Byte> stream,
                             typename P::template Span<const typename P::U16> cumulative,
                             typename P::template Span<typename P::Byte> decoded, int symbols,
                             int count) {
  using I = typename P::I32;
  using U = typename P::U32;
  using Byte = typename P::Byte;
  constexpr std::uint32_t kLeast = 1u << 24;
  const typename P::Function function("unseen_range_decode");
  const I length = stream.size();
  const I total = cumulative[symbols];
  I position = 4;
  U code = 0u;
  for (int i = 0; i < 4; ++i) code = (code << 8) | U(I(stream[i]));
  U range = 0xffffffffu;
  for (int i : P::range(0, count)) {
    range /= U(total);
    I target = I(U(code / range));
    if (target >= total) target = total - 1;
    I symbol = 0;
    while (I(cumulative[symbol + 1]) <= target) ++symbol;
    const I low = cumulative[symbol];
    const I high = cumulative[symbol + 1];
    code -= U(low) * range;
    range *= U(I(high - low));
    while (range < U(kLeast)) {
      I next = 0;
      if (position < length) next = stream[position];
      ++position;
      code = (code << 8) | U(next);
      range <<= 8;
    }
    decoded[i] = work::narrow<Byte>(symbol);
  }
  return position;
}

/// Numbers the connected components (of four neighbours) of pixels above a threshold, from 1.
/// `labels` has a row of its own above the image, `parent` room for all provisional labels.
/// Returns the number of components.
template <class P>
typename P::I32 label_components(typename P::template Span<const typename P::Byte> image,
                                 typename P::template Span<typename P::U16> labels,
                                 typename P::template Span<typename P::U16> parent, int width,
                                 int height, int threshold) {
  using I = typename P::I32;
  using U16 = typename P::U16;
  const typename P::Function function("unseen_label_components");
  const I least = threshold;
  for (int x : P::range(0, width)) labels[x] = U16{0};
  parent[0] = U16{0};
  I last = 0;
  for (int y : P::range(0, height)) {
    I left = 0;
    for (int x : P::range(0, width)) {
      I label = 0;
      if (I(image[y * width + x]) > least) {
        const I up = labels[y * width + x];
        if (left == 0 && up == 0) {
          ++last;
          parent[last] = work::narrow<U16>(last);
          label = last;
        } else if (up == 0) {
          label = left;
        } else if (left == 0 || left == up) {
          label = up;
        } else {
          I a = left;
          I next = parent[a];
          while (next != a) {
            a = next;
            next = parent[a];
          }
          I b = up;
          next = parent[b];
          while (next != b) {
            b = next;
            next = parent[b];
          }
          label = work::min(a, b);
          parent[work::max(a, b)] = work::narrow<U16>(label);
        }
      }
      labels[(y + 1) * width + x] = work::narrow<U16>(label);
      left = label;
    }
  }
  // A parent has a smaller number than its children, so it has its final one before them.
  I components = 0;
  for (int i : P::range(1, work::value(last) + 1)) {
    const I above = parent[i];
    if (above == I(i)) {
      ++components;
      parent[i] = work::narrow<U16>(components);
    } else {
      parent[i] = work::narrow<U16>(I(parent[above]));
    }
  }
  for (int y : P::range(1, height + 1)) {
    for (int x : P::range(0, width)) {
      const I label = labels[y * width + x];
      if (label != 0) labels[y * width + x] = work::narrow<U16>(I(parent[label]));
    }
  }
  return components;
}

/// How the numbers of a layer are quantised.
struct Quantisation {
  int zero_input;
  int zero_weight;
  int zero_output;
  int multiplier;  ///< of 2^32
  int shift;       ///< right, at least 1
};

/// Fully connected layer: 8-bit inputs, weights (a row for each output) and outputs.
template <class P>
void dense_u8(typename P::template Span<const typename P::Byte> input,
              typename P::template Span<const typename P::Byte> weights,
              typename P::template Span<const typename P::I32> bias,
              typename P::template Span<typename P::Byte> output, int inputs, int outputs,
              const Quantisation& quantisation) {
  using I = typename P::I32;
  using Byte = typename P::Byte;
  const typename P::Function function("unseen_dense_u8");
  const I zero_input = quantisation.zero_input;
  const I zero_weight = quantisation.zero_weight;
  const I zero_output = quantisation.zero_output;
  const I multiplier = quantisation.multiplier;
  const int shift = quantisation.shift;
  const I rounding = 1 << (shift - 1);
  for (int o : P::range(0, outputs)) {
    I sum = bias[o];
    for (int i : P::range(0, inputs)) {
      const I x = I(input[i]) - zero_input;
      const I w = I(weights[o * inputs + i]) - zero_weight;
      sum += x * w;
    }
    const I scaled = ((work::mul_high(sum, multiplier) + rounding) >> shift) + zero_output;
    output[o] = work::narrow<Byte>(work::min(work::max(scaled, I(0)), I(255)));
  }
}

}  // namespace leviosim::unseen
