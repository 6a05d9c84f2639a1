// A product of matrices of bytes, scheduled by hand as a public library has it, and what
// leviosim-measure runs of it: leviosim-measure int8_product.h int8_product_code.h --isa
// rv32imfc,rv32imfc_xpulp
#pragma once

#include "sim/work/packed.h"
#include "sim/work/policy.h"

/// c = a b of n x n bytes, sums of 32 bits, in blocks of two rows and four columns, of which an
/// inner step takes four values of the rows and columns: six loads, eight shuffles that turn four
/// words of b, eight dot products. Columns of blocks are dealt to the cores in turn.
template <class P>
void multiply_int8(typename P::template Span<const leviosim::work::I8x4<P>> a,
                   typename P::template Span<const leviosim::work::I8x4<P>> b,
                   typename P::template Span<typename P::I32> c, int n, int core, int cores) {
  namespace work = leviosim::work;
  using I32 = typename P::I32;
  using Word = work::I8x4<P>;
  using Words = typename P::template Span<const Word>;
  const typename P::Function function("multiply_int8");
  const int words = n / 4;
  const int columns = (words - core + cores - 1) / cores;
  I32 column_at = work::copied(I32(core));
  for ([[maybe_unused]] const int column : P::range(0, columns)) {
    I32 left_at = work::copied(I32(0));
    I32 sums_at = column_at << 2;
    for ([[maybe_unused]] const int row : P::range(0, n / 2)) {
      const Words rows[2] = {a.subspan(left_at, words), a.subspan(left_at + I32(words), words)};
      Words below[4];
      I32 below_at = column_at;
      for (int i = 0; i < 4; ++i) {
        if (i > 0) below_at += I32(words);
        below[i] = b.subspan(below_at, (n - 4) * words + 1);
      }
      I32 sums[2][4];
      for (auto& of_row : sums)
        for (I32& sum : of_row) sum = work::copied(I32(0));
      for (const int k : P::range(0, words)) {
        const Word left[2] = {rows[0][k], rows[1][k]};
        Word right[4];
        for (int i = 0; i < 4; ++i) right[i] = below[i][4 * k * words];
        const Word upper[2] = {work::select<0, 4, 1, 5>(right[0], right[1]),
                               work::select<2, 6, 3, 7>(right[0], right[1])};
        const Word lower[2] = {work::select<0, 4, 1, 5>(right[2], right[3]),
                               work::select<2, 6, 3, 7>(right[2], right[3])};
        for (int j = 0; j < 4; ++j) {
          const Word column_of_b = j % 2 == 0
                                       ? work::select<0, 1, 4, 5>(upper[j / 2], lower[j / 2])
                                       : work::select<2, 3, 6, 7>(upper[j / 2], lower[j / 2]);
          for (int i = 0; i < 2; ++i) sums[i][j] = dot(left[i], column_of_b, sums[i][j]);
        }
      }
      I32 result_at = sums_at;
      for (int i = 0; i < 2; ++i) {
        if (i > 0) result_at += I32(n);
        const auto results = c.subspan(result_at, 4);
        for (int j = 0; j < 4; ++j) results[j] = sums[i][j];
      }
      left_at += I32(2 * words);
      sums_at += I32(2 * n);
    }
    column_at += I32(cores);
  }
}

template <class P>
void scenes() {
  using Word = leviosim::work::I8x4<P>;
  constexpr int kSize = 32;
  static Word a[kSize * kSize / 4], b[kSize * kSize / 4];
  static typename P::I32 c[kSize * kSize];
  for (int i = 0; i < kSize * kSize / 4; ++i) a[i] = b[i] = {};
  // Volatile: what compilers know of inputs they would compute beforehand.
  volatile int size = kSize;
  Word* volatile at_a = a;
  Word* volatile at_b = b;
  typename P::I32* volatile at_c = c;
  const int n = size;
  const typename P::Function scene("scene: product of bytes");
  multiply_int8<P>({at_a, n * n / 4}, {at_b, n * n / 4}, {at_c, n * n}, n, 0, 1);
}
