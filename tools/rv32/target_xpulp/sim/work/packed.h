// Stands in for the packed integers of sim/work where code is compiled for Xpulp, which the
// compiler does not know: an operation is one instruction, with the registers of Xpulp's. So
// spills, moves before an instruction that overwrites an operand, and addresses are those that a
// compiler makes. Values are wrong: what kernels do may depend on the number of values only.
#pragma once

#include <cstdint>
#include <type_traits>

#include "sim/work/functions.h"
#include "sim/work/memory.h"

namespace leviosim::work {

enum class SignedByte : std::int8_t {};
template <>
struct LoadedAs<SignedByte> {
  using Type = I32;
  static Type from(SignedByte stored) { return I32(static_cast<std::int32_t>(stored)); }
};

/// An instruction that writes a register of its own, and one that overwrites an operand.
inline std::int32_t packed_instruction(std::int32_t a, std::int32_t b) {
  std::int32_t result;
  asm("xor %0, %1, %2" : "=r"(result) : "r"(a), "r"(b));
  return result;
}
inline std::int32_t overwriting_instruction(std::int32_t into, std::int32_t a, std::int32_t b) {
  asm("xor %0, %1, %2" : "+r"(into) : "r"(a), "r"(b));
  return into;
}

template <class Lane, int N, bool Counted>
struct Packed {
  static_assert(!Counted && sizeof(Lane) * N == 4);
  using Scalar = std::int32_t;

  union {
    Lane lanes[N];
    std::int32_t word;  ///< in a register
  };

  static Packed of_register(Scalar x) {
    Packed out;
    out.word = x;
    return out;
  }
  Scalar lane(int i) const { return lanes[i]; }
  friend Packed operator+(const Packed& a, const Packed& b) { return each(a, b); }
  friend Packed operator-(const Packed& a, const Packed& b) { return each(a, b); }
  friend Packed min(const Packed& a, const Packed& b) { return each(a, b); }
  friend Packed max(const Packed& a, const Packed& b) { return each(a, b); }
  friend Scalar dot(const Packed& a, const Packed& b) { return packed_instruction(a.word, b.word); }
  friend Scalar dot(const Packed& a, const Packed& b, Scalar sum) {
    return overwriting_instruction(sum, a.word, b.word);
  }
  /// No instruction of its own: the larger, the smaller, their difference, its sum.
  friend Scalar add_differences(const Packed& a, const Packed& b, Scalar sum) {
    const Packed larger = max(a, b), smaller = min(a, b);
    return dot(larger - smaller, larger, sum);
  }
  friend Packed average(const Packed& a, const Packed& b) {
    return (a - b) + (each(a, b) + (b - a));  // five, as without Xpulp
  }

 private:
  static Packed each(const Packed& a, const Packed& b) {
    return of_register(packed_instruction(a.word, b.word));
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

template <class Vector>
Vector splat(int x) {
  return Vector::of_register(x);
}

/// It overwrites one of its operands; which lanes it takes stands in a register.
template <int... Index, class Lane, int N, bool Counted>
Packed<Lane, N, Counted> select(const Packed<Lane, N, Counted>& a,
                                const Packed<Lane, N, Counted>& b) {
  std::int32_t lanes = 0;
  ((lanes = lanes << 8 | Index), ...);
  return Packed<Lane, N, Counted>::of_register(overwriting_instruction(b.word, a.word, lanes));
}

template <class Span>
Span from_byte(const Span& words, int bytes) {
  using Vector = std::remove_pointer_t<decltype(words.data())>;
  using Raw = std::conditional_t<std::is_const_v<Vector>, const char, char>;
  auto* at = reinterpret_cast<Vector*>(reinterpret_cast<Raw*>(words.data()) + bytes);
  return Span(at, words.size() - (bytes + 3) / 4, bytes % 4 != 0);
}

template <class P>
typename P::template Span<const SignedByte> bytes_of(
    const typename P::template Span<const I8x4<P>>& words, int first) {
  return {reinterpret_cast<const SignedByte*>(words.data()) + first, 4 * words.size() - first};
}

}  // namespace leviosim::work
