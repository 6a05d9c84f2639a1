// The board's kernels compute what they are meant to, with the same bits under both policies.
#include "tools/app/validation/microbench/board_programs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace leviosim::tools {
namespace {

using work::Native;
using work::Share;

int pixel(int i) { return (i * 7919 + i / 112 * 31) % 251 - 125; }

template <class P>
class Memory {
 public:
  template <class T>
  typename P::template Span<T> filled(int n, int (*value)(int)) {
    auto span = arena_.alloc<typename P::template Span<T>>("block", n);
    for (int i = 0; i < n; ++i) span.data()[i] = static_cast<T>(value(i));
    return span;
  }
  /// Words whose lanes are consecutive values.
  template <class Vector>
  typename P::template Span<Vector> packed(int n, int (*value)(int)) {
    constexpr int kLanes = sizeof(Vector{}.lanes) / sizeof(Vector{}.lanes[0]);
    auto span = arena_.alloc<typename P::template Span<Vector>>("block", n);
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < kLanes; ++k)
        span.data()[i].lanes[k] =
            static_cast<std::decay_t<decltype(Vector{}.lanes[0])>>(value(i * kLanes + k));
    return span;
  }

 private:
  work::Arena arena_{"L1", Bytes(64 * 1024)};
};

template <class Span>
std::vector<int> values(const Span& span) {
  return {span.data(), span.data() + span.size()};
}

int zero(int) { return 0; }
int weight(int i) { return (i * 37) % 19 - 9; }

template <class P>
std::vector<int> pooled(bool average, bool simd) {
  Memory<P> memory;
  const auto out = memory.template filled<Sample>(kPooled * kPooled, zero);
  const Share all{0, kPooled};
  if (simd) {
    const auto in = memory.template packed<work::I16x2<P>>(kPoolSize * kPooled, pixel);
    average ? average_pool_simd<P>(in, out, all) : max_pool_simd<P>(in, out, all);
  } else {
    const auto in = memory.template filled<Sample>(kPoolSize * kPoolSize, pixel);
    average ? average_pool<P>(in, out, all) : max_pool<P>(in, out, all);
  }
  return values(out);
}

TEST(BoardPrograms, PoolsTakeTheLargestOrTheMeanOfEachWindow) {
  std::vector<int> largest;
  std::vector<int> mean;
  for (int y = 0; y < kPooled; ++y)
    for (int x = 0; x < kPooled; ++x) {
      const int at = 2 * y * kPoolSize + 2 * x;
      const int p[] = {pixel(at), pixel(at + 1), pixel(at + kPoolSize), pixel(at + kPoolSize + 1)};
      largest.push_back(*std::max_element(p, p + 4));
      mean.push_back((p[0] + p[1] + p[2] + p[3]) >> 2);
    }
  for (const bool simd : {false, true}) {
    EXPECT_EQ(pooled<Native>(false, simd), largest);
    EXPECT_EQ(pooled<work::Counting>(false, simd), largest);
    EXPECT_EQ(pooled<Native>(true, simd), mean);
    EXPECT_EQ(pooled<work::Counting>(true, simd), mean);
  }
}

/// Row, column or corner of the weights as convolve_simd() wants them.
int arranged_weight(int i) {
  const int word = i / 4;
  const int lane = i % 4;
  if (word < kWindow) return weight(word * kWindow + lane);
  if (word == kWindow) return weight(lane * kWindow + kWindow - 1);
  return lane == 0 ? weight(kWindow * kWindow - 1) : 0;
}

template <class P>
std::vector<int> convolved(bool simd) {
  Memory<P> memory;
  const auto out = memory.template filled<Sample>(kConvolved * kConvolved, zero);
  const Share all{0, kConvolved};
  if (simd)
    convolve_simd<P>(memory.template packed<work::I8x4<P>>(kPoolSize * kPoolSize / 4, pixel),
                     memory.template packed<work::I8x4<P>>(kWindow + 2, arranged_weight), out, all);
  else
    convolve<P>(memory.template filled<Sample>(kPoolSize * kPoolSize, pixel),
                memory.template filled<Sample>(kWindow * kWindow, weight), out, all);
  return values(out);
}

TEST(BoardPrograms, TheConvolutionsAgree) {
  std::vector<int> expected;
  for (int y = 0; y < kConvolved; ++y)
    for (int x = 0; x < kConvolved; ++x) {
      int sum = 0;
      for (int v = 0; v < kWindow; ++v)
        for (int u = 0; u < kWindow; ++u)
          sum += pixel((y + v) * kPoolSize + x + u) * weight(v * kWindow + u);
      expected.push_back(sum >> kNorm);
    }
  for (const bool simd : {false, true}) {
    EXPECT_EQ(convolved<Native>(simd), expected);
    EXPECT_EQ(convolved<work::Counting>(simd), expected);
  }
}

template <class P>
std::vector<int> layer(bool simd) {
  Memory<P> memory;
  const auto out = memory.template filled<Sample>(kOutputs, zero);
  const Share all{0, kOutputs};
  if (simd)
    linear_simd<P>(memory.template packed<work::I8x4<P>>(kInputs / 4, pixel),
                   memory.template packed<work::I8x4<P>>(kInputs * kOutputs / 4, weight), out, all);
  else
    linear<P>(memory.template filled<Sample>(kInputs, pixel),
              memory.template filled<Sample>(kInputs * kOutputs, weight), out, all);
  return values(out);
}

TEST(BoardPrograms, TheLinearLayersAgree) {
  std::vector<int> expected;
  for (int o = 0; o < kOutputs; ++o) {
    int sum = 0;
    for (int i = 0; i < kInputs; ++i) sum += pixel(i) * weight(o * kInputs + i);
    expected.push_back(static_cast<Sample>(sum >> kNorm));
  }
  for (const bool simd : {false, true}) {
    EXPECT_EQ(layer<Native>(simd), expected);
    EXPECT_EQ(layer<work::Counting>(simd), expected);
  }
}

bool bit(int y, int x) { return (y * 131 + x * x * 7 + x * y) % 3 == 0; }

int bits_of_word(int i) {
  std::uint32_t word = 0;
  for (int k = 0; k < 32; ++k)
    word |= std::uint32_t{bit(i / kBinaryWords, i % kBinaryWords * 32 + k)} << k;
  return static_cast<int>(word);
}

constexpr std::uint32_t kFilter = 0x15a3c96;

template <class P>
std::vector<int> matched() {
  Memory<P> memory;
  const auto out = memory.template filled<Sample>(kBinaryOut * kBinaryOut, [](int) { return 3; });
  auto words = memory.template filled<std::uint32_t>(kBinarySize * kBinaryWords, bits_of_word);
  typename P::template Span<typename P::U32> in(reinterpret_cast<typename P::U32*>(words.data()),
                                                words.size());
  xnor_convolve<P>(in, kFilter, out, {0, kBinaryOut});
  return values(out);
}

TEST(BoardPrograms, TheBinaryConvolutionCountsEqualPixels) {
  std::vector<int> expected;
  for (int y = 0; y < kBinaryOut; ++y)
    for (int x = 0; x < kBinaryOut; ++x) {
      int sum = 3;
      for (int v = 0; v < kWindow; ++v)
        for (int u = 0; u < kWindow; ++u) {
          const bool wanted = kFilter >> ((kWindow - 1 - v) * kWindow + u) & 1U;
          sum += bit(y + v, x + u) == wanted ? 1 : -1;
        }
      expected.push_back(sum);
    }
  EXPECT_EQ(matched<Native>(), expected);
  EXPECT_EQ(matched<work::Counting>(), expected);
}

}  // namespace
}  // namespace leviosim::tools
