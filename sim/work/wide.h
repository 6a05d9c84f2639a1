// 64-bit integers and the upper half of 32-bit products: what fixed-point code with large products
// uses. Sums wrap. The bits are the same under both policies.
#pragma once

#include <cstdint>
#include <type_traits>

#include "sim/work/functions.h"

namespace leviosim::work {

/// Counted 64-bit integer.
struct CountedI64 {
  static constexpr Op kMul = Op::Int64Mul;
  static constexpr Op kMulAdd = Op::Int64Mac;

  std::int64_t v;

  CountedI64() = default;
  constexpr CountedI64(std::int64_t value) : v(value) {}

  static constexpr std::int64_t wrap_add(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
  }
  static constexpr std::int64_t wrap_sub(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
  }
  friend CountedI64 operator+(CountedI64 a, CountedI64 b) {
    count(Op::Int64Add);
    return CountedI64(wrap_add(a.v, b.v));
  }
  friend CountedI64 operator-(CountedI64 a, CountedI64 b) {
    count(Op::Int64Add);
    return CountedI64(wrap_sub(a.v, b.v));
  }
  CountedI64& operator+=(CountedI64 b) { return *this = *this + b; }
  CountedI64& operator+=(Product<CountedI64> b) { return *this = *this + b; }
  CountedI64& operator-=(CountedI64 b) { return *this = *this - b; }
  CountedI64& operator-=(Product<CountedI64> b) { return *this = *this - b; }
};

template <class P>
using I64 = std::conditional_t<P::kCounting, CountedI64, std::int64_t>;

/// The whole product.
inline std::int64_t mul_wide(std::int32_t a, std::int32_t b) { return std::int64_t{a} * b; }
inline Product<CountedI64> mul_wide(I32 a, I32 b) {
  return Product<CountedI64>(mul_wide(a.v, b.v));
}

/// Its upper 32 bits.
inline std::int32_t mul_high(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(mul_wide(a, b) >> 32);
}
inline std::uint32_t mul_high(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint32_t>((std::uint64_t{a} * b) >> 32);
}
inline I32 mul_high(I32 a, I32 b) {
  count(Op::IntMulHigh);
  return I32(mul_high(a.v, b.v));
}
inline U32 mul_high(U32 a, U32 b) {
  count(Op::IntMulHigh);
  return U32(mul_high(a.v, b.v));
}

inline std::int64_t value(std::int64_t x) { return x; }
inline std::int64_t value(CountedI64 x) { return x.v; }

}  // namespace leviosim::work
