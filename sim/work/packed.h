// Packed integers of 32 bits: two of 16 or four of 8. What a workload written for a core with SIMD
// instructions uses; other instruction sets cost the same operations as sequences.
//
//   work::I8x4<P> a = x[i], b = w[i];
//   sum = work::dot(a, b, sum);             // one simd_dot
//   auto pair = work::select<0, 4, 1, 5>(a, b);  // one simd_alu
//
// Lanes wrap when they overflow. Sums of products are 32 bits wide. The bits are the same under
// both policies. Left out: packed comparisons and shifts, which no workload needs yet.
#pragma once

#include <cstdint>
#include <type_traits>

#include "sim/work/functions.h"
#include "sim/work/memory.h"

namespace leviosim::work {

/// Storage of a signed byte; an enumeration for the same reason as Byte.
enum class SignedByte : std::int8_t {};
template <>
struct LoadedAs<SignedByte> {
  using Type = I32;
  static Type from(SignedByte stored) { return I32(static_cast<std::int32_t>(stored)); }
};

template <class Lane, int N, bool Counted>
struct Packed {
  static_assert(sizeof(Lane) * N == 4);
  using Scalar = std::conditional_t<Counted, I32, std::int32_t>;

  Lane lanes[N];

  /// The 32 bits of a word seen as lanes: nothing is counted.
  static Packed of_register(Scalar x) {
    Packed out;
    const auto bits = static_cast<std::uint32_t>(value(x));
    for (int i = 0; i < N; ++i) out.lanes[i] = static_cast<Lane>(bits >> (i * 32 / N));
    return out;
  }

  /// Lane i sign- or zero-extended into a register: one extraction.
  Scalar lane(int i) const {
    note(Op::IntAlu);
    return Scalar(static_cast<std::int32_t>(lanes[i]));
  }
  friend Packed operator+(const Packed& a, const Packed& b) {
    return each(Op::SimdAlu, a, b, [](int x, int y) { return x + y; });
  }
  friend Packed operator-(const Packed& a, const Packed& b) {
    return each(Op::SimdAlu, a, b, [](int x, int y) { return x - y; });
  }
  friend Packed min(const Packed& a, const Packed& b) {
    return each(Op::SimdMinMax, a, b, [](int x, int y) { return y < x ? y : x; });
  }
  friend Packed max(const Packed& a, const Packed& b) {
    return each(Op::SimdMinMax, a, b, [](int x, int y) { return x < y ? y : x; });
  }
  friend Scalar dot(const Packed& a, const Packed& b) {
    note(Op::SimdDot);
    return Scalar(static_cast<std::int32_t>(products(a, b)));
  }
  /// sum + a·b, in one operation.
  friend Scalar dot(const Packed& a, const Packed& b, Scalar sum) {
    note(Op::SimdDot);
    return Scalar(
        static_cast<std::int32_t>(products(a, b) + static_cast<std::uint32_t>(value(sum))));
  }

  /// sum + |a - b|, added over the lanes.
  friend Scalar add_differences(const Packed& a, const Packed& b,
                                Scalar sum) requires std::is_same_v<Lane, std::uint8_t> {
    note(Op::SimdSad);
    std::int32_t differences = 0;
    for (int i = 0; i < N; ++i)
      differences += a.lanes[i] < b.lanes[i] ? b.lanes[i] - a.lanes[i] : a.lanes[i] - b.lanes[i];
    return Scalar(value(sum) + differences);
  }
  /// (a + b) / 2 in each lane, rounded down; the sum does not wrap.
  friend Packed average(const Packed& a,
                        const Packed& b) requires std::is_same_v<Lane, std::uint8_t> {
    return each(Op::SimdAverage, a, b, [](int x, int y) { return (x + y) >> 1; });
  }

  static void note(Op op) {
    if constexpr (Counted) count(op);
  }

 private:
  template <class F>
  static Packed each(Op op, const Packed& a, const Packed& b, F f) {
    note(op);
    Packed out;
    for (int i = 0; i < N; ++i) out.lanes[i] = static_cast<Lane>(f(a.lanes[i], b.lanes[i]));
    return out;
  }
  static std::uint32_t products(const Packed& a, const Packed& b) {
    std::uint32_t sum = 0;
    for (int i = 0; i < N; ++i)
      sum += static_cast<std::uint32_t>(std::int64_t{a.lanes[i]} * b.lanes[i]);
    return sum;
  }
};

template <class P>
using I16x2 = Packed<std::int16_t, 2, P::kCounting>;
template <class P>
using U16x2 = Packed<std::uint16_t, 2, P::kCounting>;
template <class P>
using I8x4 = Packed<std::int8_t, 4, P::kCounting>;
template <class P>
using U8x4 = Packed<std::uint8_t, 4, P::kCounting>;

/// A constant with the same value in all lanes; in a register, so nothing is counted.
template <class Vector>
Vector splat(int x) {
  Vector out;
  for (auto& lane : out.lanes) lane = static_cast<std::remove_reference_t<decltype(lane)>>(x);
  return out;
}

/// Lanes chosen from those of a (0 … N-1) and b (N … 2N-1): one shuffle or pack.
template <int... Index, class Lane, int N, bool Counted>
Packed<Lane, N, Counted> select(const Packed<Lane, N, Counted>& a,
                                const Packed<Lane, N, Counted>& b) {
  static_assert(sizeof...(Index) == N && ((Index >= 0 && Index < 2 * N) && ...));
  Packed<Lane, N, Counted>::note(Op::SimdAlu);
  return {{(Index < N ? a.lanes[Index % N] : b.lanes[Index % N])...}};
}

/// The words that begin `bytes` after those of a view of four bytes each. Cores load words from any
/// address; those that cross a word of the memory count as straddling.
template <class Span>
Span from_byte(const Span& words, int bytes) {
  using Vector = std::remove_pointer_t<decltype(words.data())>;
  static_assert(sizeof(Vector) == 4 && alignof(Vector) == 1);
  using Raw = std::conditional_t<std::is_const_v<Vector>, const char, char>;
  auto* at = reinterpret_cast<Vector*>(reinterpret_cast<Raw*>(words.data()) + bytes);
  return Span(at, words.size() - (bytes + 3) / 4, bytes % 4 != 0);
}

/// The single bytes of such a view, from one of them on.
template <class P>
typename P::template Span<const SignedByte> bytes_of(
    const typename P::template Span<const I8x4<P>>& words, int first) {
  return {reinterpret_cast<const SignedByte*>(words.data()) + first, 4 * words.size() - first};
}

}  // namespace leviosim::work
