// Elementary functions and conversions that kernels call, for plain and for counted scalars alike:
// `work::sqrt(x)` is the same source under both policies and computes the same bits.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "sim/work/counted.h"

namespace leviosim::work {

/// A value in one more register: a counter that is set, a window that moves on, an address that is
/// kept, a number brought into the range of its type. For code whose author knows what compilers
/// otherwise decide (the platform's instruction overhead stands for that).
template <class T>
T copied(T x) {
  if constexpr (!std::is_arithmetic_v<T>) count(Op::IntAlu);
  return x;
}

// ---- plain scalars (native policy) ----
inline float sqrt(float x) { return std::sqrt(x); }
inline float abs(float x) { return std::fabs(x); }
inline float min(float a, float b) { return b < a ? b : a; }
inline float max(float a, float b) { return a < b ? b : a; }
/// (a + b) >> places: what instruction sets for signal processing do in one instruction. The sum
/// wraps.
inline std::int32_t add_shifted(std::int32_t a, std::int32_t b, int places) {
  return I32::wrap_add(a, b) >> places;
}
inline std::int32_t abs(std::int32_t x) { return x < 0 ? -x : x; }
inline std::int32_t min(std::int32_t a, std::int32_t b) { return b < a ? b : a; }
inline std::int32_t max(std::int32_t a, std::int32_t b) { return a < b ? b : a; }
/// Sums of pairs, nibbles and bytes. The host vectorises it; std::popcount would be a library call
/// on hosts whose baseline has no such instruction.
inline std::int32_t popcount(std::uint32_t x) {
#if defined(__riscv_zbb)
  return __builtin_popcount(x);
#elif defined(__riscv)  // one instruction, as on the chips that count it as one: Zbb's
  std::int32_t bits;
  asm(".insn i 0x13, 1, %0, %1, 0x602" : "=r"(bits) : "r"(x));
  return bits;
#else
  x -= (x >> 1) & 0x55555555u;
  x = (x & 0x33333333u) + ((x >> 2) & 0x33333333u);
  x = (x + (x >> 4)) & 0x0f0f0f0fu;
  x += x >> 8;
  return static_cast<std::int32_t>((x + (x >> 16)) & 0x3fu);
#endif
}
inline float to_f32(std::int32_t x) { return static_cast<float>(x); }
inline float to_f32(double x) { return static_cast<float>(x); }
inline double to_f64(float x) { return static_cast<double>(x); }
/// Truncates towards zero; |x| must be below 2^31.
inline std::int32_t to_i32(float x) { return static_cast<std::int32_t>(x); }
/// True for numbers that are neither infinite nor NaN. A guard of the host's, not counted.
inline bool is_finite(float x) { return std::isfinite(x); }
/// The plain value of a scalar, for reading results out; never part of counted work.
inline float value(float x) { return x; }
inline double value(double x) { return x; }
inline std::int32_t value(std::int32_t x) { return x; }
inline std::uint32_t value(std::uint32_t x) { return x; }
inline bool value(bool x) { return x; }
/// `if (work::unlikely(x > largest))`: for loops that look for something rare.
inline bool unlikely(bool condition) { return condition; }
/// The bits of a float as an integer and back: a change of view where both live in the same
/// registers.
inline std::int32_t bits_of(float x) { return std::bit_cast<std::int32_t>(x); }
inline float float_of_bits(std::int32_t x) { return std::bit_cast<float>(x); }

// ---- counted scalars ----
inline UnlikelyCond unlikely(Cond condition) { return {condition.v}; }
inline F32 sqrt(F32 x) {
  count(Op::F32Sqrt);
  return F32(std::sqrt(x.v));
}
inline F32 abs(F32 x) {
  count(Op::F32Sign);
  return F32(abs(x.v));
}
inline F32 min(F32 a, F32 b) {
  count(Op::F32Sign);
  return F32(min(a.v, b.v));
}
inline F32 max(F32 a, F32 b) {
  count(Op::F32Sign);
  return F32(max(a.v, b.v));
}
inline I32 add_shifted(I32 a, I32 b, int places) {
  count(Op::IntAddShift);
  return I32(I32::wrap_add(a.v, b.v) >> places);
}
inline I32 abs(I32 x) {
  count(Op::IntMinMax);
  return I32(abs(x.v));
}
inline I32 min(I32 a, I32 b) {
  count(Op::IntMinMax);
  return I32(min(a.v, b.v));
}
inline I32 max(I32 a, I32 b) {
  count(Op::IntMinMax);
  return I32(max(a.v, b.v));
}
inline I32 popcount(U32 x) {
  count(Op::Popcount);
  return I32(popcount(x.v));
}
inline F32 to_f32(I32 x) {
  count(Op::F32Convert);
  return F32(to_f32(x.v));
}
inline F32 to_f32(F64 x) {
  count_routine(Op::F64Convert, Routine::F64Narrow);
  return F32(to_f32(x.v));
}
inline F64 to_f64(F32 x) {
  count_routine(Op::F64Convert, Routine::F64Widen);
  return F64(to_f64(x.v));
}
inline I32 to_i32(F32 x) {
  count(Op::F32Convert);
  return I32(to_i32(x.v));
}
inline bool is_finite(F32 x) { return is_finite(x.v); }
inline float value(F32 x) { return x.v; }
inline double value(F64 x) { return x.v; }
inline PlainInt value(I32 x) { return {x.v}; }
inline std::uint32_t value(U32 x) { return x.v; }
inline bool value(Cond x) { return x.v; }
inline I32 bits_of(F32 x) { return I32(bits_of(x.v)); }
inline F32 float_of_bits(I32 x) { return F32(float_of_bits(x.v)); }

}  // namespace leviosim::work
