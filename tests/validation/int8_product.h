// A product of matrices of bytes, scheduled by hand as a public library has it, and what
// leviosim-measure runs of it: leviosim-measure int8_product.h int8_product_code.h --isa
// rv32imfc,rv32imfc_xpulp
#pragma once

#include "sim/work/packed.h"
#include "sim/work/policy.h"

/// c = a b of n x n bytes, sums of 32 bits, in blocks of 4x2 of which an inner step takes four
/// values of the rows and columns. a has the bytes of a row four by four, b two by two. Columns of
/// blocks are dealt to the cores in turn.
template <class P>
void multiply_int8(typename P::template Span<const leviosim::work::I8x4<P>> a,
                   typename P::template Span<const typename P::U16> b,
                   typename P::template Span<typename P::I32> c, int n, int core, int cores) {
  namespace work = leviosim::work;
  using I32 = typename P::I32;
  using Word = work::I8x4<P>;
  const typename P::Function function("multiply_int8");
  const int words = n / 4;
  const int pairs = n / 2;
  const int columns = (pairs - core + cores - 1) / cores;
  I32 column_at = work::copied(I32(core));
  for ([[maybe_unused]] const int column : P::range(0, columns)) {
    I32 left_at = work::copied(I32(0));
    I32 sums_at = column_at + column_at;
    for ([[maybe_unused]] const int row : P::range(0, n / 4)) {
      typename P::template Span<const Word> rows[4];
      I32 row_at = left_at;
      for (int i = 0; i < 4; ++i) {
        if (i > 0) row_at += I32(words);
        rows[i] = a.subspan(row_at, words);
      }
      typename P::template Span<const typename P::U16> below[4];
      I32 below_at = column_at;
      for (int i = 0; i < 4; ++i) {
        if (i > 0) below_at += I32(pairs);
        below[i] = b.subspan(below_at, (n - 4) * pairs + 1);
      }
      I32 sums[4][2];
      for (auto& of_row : sums)
        for (I32& sum : of_row) sum = work::copied(I32(0));
      for (const int k : P::range(0, words)) {
        Word left[4], right[4];
        for (int i = 0; i < 4; ++i) left[i] = rows[i][k];
        for (int i = 0; i < 4; ++i) right[i] = Word::of_register(I32(below[i][4 * k * pairs]));
        const Word right_of[2] = {
            work::select<0, 1, 4, 5>(work::select<0, 4, 0, 4>(right[0], right[1]),
                                     work::select<0, 4, 0, 4>(right[2], right[3])),
            work::select<0, 1, 4, 5>(work::select<1, 5, 1, 5>(right[0], right[1]),
                                     work::select<1, 5, 1, 5>(right[2], right[3]))};
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 2; ++j) sums[i][j] = dot(left[i], right_of[j], sums[i][j]);
      }
      I32 result_at = sums_at;
      for (int i = 0; i < 4; ++i) {
        if (i > 0) result_at += I32(n);
        const auto results = c.subspan(result_at, 2);
        for (int j = 0; j < 2; ++j) results[j] = sums[i][j];
      }
      left_at += I32(4 * words);
      sums_at += I32(4 * n);
    }
    column_at += I32(cores);
  }
}

template <class P>
void scenes() {
  using Word = leviosim::work::I8x4<P>;
  constexpr int kSize = 32;
  static Word a[kSize * kSize / 4];
  static typename P::U16 b[kSize * kSize / 2];
  static typename P::I32 c[kSize * kSize];
  for (int i = 0; i < kSize * kSize / 4; ++i) a[i] = {};
  // Volatile: what compilers know of inputs they would compute beforehand.
  volatile int size = kSize;
  Word* volatile at_a = a;
  typename P::U16* volatile at_b = b;
  typename P::I32* volatile at_c = c;
  const int n = size;
  const typename P::Function scene("scene: product of bytes");
  multiply_int8<P>({at_a, n * n / 4}, {at_b, n * n / 2}, {at_c, n * n}, n, 0, 1);
}
