// Counted scalars: thin wrappers around float, double and 32-bit integers whose operators also
// count. The value computed is bit-identical to the plain type's (the library is compiled with
// -ffp-contract=off); only the *count* of a product that is at once added knows about the fused
// multiply-add of the target, whose compilers contract a*b+c by default (FACTS.md#instruction-set).
//
// A comparison gives a Cond. It becomes a counted branch when the program decides on it (if, while,
// ?:, &&, ||): false means that the branch around the guarded code is taken.
#pragma once

#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <type_traits>

#include "sim/work/code_events.h"
#include "sim/work/counts.h"
#include "sim/work/op.h"

namespace leviosim::work {

/// Outcome of a counted comparison. Deciding on it counts a branch.
struct Cond {
  bool v;
  explicit operator bool() const {
    count(Op::BranchNotTaken);  // of all branches, see tally
    count(Op::BranchTaken, !v);
    return v;
  }
  /// The negated condition; a compiler inverts the branch instead of computing it.
  friend Cond operator!(Cond c) { return {!c.v}; }
};

/// A condition that seldom holds, which the host may know: counting then costs nothing where it
/// does not. What is counted is the same.
struct UnlikelyCond {
  bool v;
  explicit operator bool() const {
    count(Op::BranchNotTaken);
    count(Op::BranchTaken);
    if (v) [[unlikely]] {
      ++branches_not_taken_after_all;
      return true;
    }
    return false;
  }
};

/// A product whose cost is still open: a multiplication if it is used as such, a multiply-add if it
/// is added to or subtracted from something.
template <class T>
struct Product {
  using Plain = decltype(T::v);
  Plain v;

  explicit Product(Plain value) : v(value) {}
  operator T() const {
    count(T::kMul);
    return T(v);
  }
  friend T operator+(Product p, T c) {
    count(T::kMulAdd);
    return T(T::wrap_add(p.v, c.v));
  }
  friend T operator+(T c, Product p) {
    count(T::kMulAdd);
    return T(T::wrap_add(c.v, p.v));
  }
  friend T operator-(Product p, T c) {
    count(T::kMulAdd);
    return T(T::wrap_sub(p.v, c.v));
  }
  friend T operator-(T c, Product p) {
    count(T::kMulAdd);
    return T(T::wrap_sub(c.v, p.v));
  }
  friend T operator+(Product p, Product q) { return p + T(q); }
  friend T operator-(Product p, Product q) { return p - T(q); }
  friend Product operator-(Product p) { return Product(T::wrap_sub(Plain{}, p.v)); }
};

/// The plain value of a counted integer, for what the host needs: sizes, bounds of loops, figures
/// of a report. It becomes an int by itself, but is no index of a view (memory.h): as an int it
/// would pass for an index of a loop, while the integer itself counts as what it is, data.
struct PlainInt {
  std::int32_t v;
  constexpr operator std::int32_t() const { return v; }
};

/// 32-bit integer, signed or unsigned. Overflow wraps, as it does on the target.
template <class Rep>
struct Int {
  using Unsigned = std::make_unsigned_t<Rep>;
  static constexpr Op kMul = Op::IntMul;
  static constexpr Op kMulAdd = Op::IntMac;

  Rep v;

  Int() = default;
  constexpr Int(Rep value) : v(value) {}
  /// Between signed and unsigned: a change of view, not an instruction.
  template <class Other>
  explicit constexpr Int(Int<Other> other) : v(static_cast<Rep>(other.v)) {}

  static constexpr Rep wrap_add(Rep a, Rep b) {
    return static_cast<Rep>(static_cast<Unsigned>(a) + static_cast<Unsigned>(b));
  }
  static constexpr Rep wrap_sub(Rep a, Rep b) {
    return static_cast<Rep>(static_cast<Unsigned>(a) - static_cast<Unsigned>(b));
  }
  static constexpr Rep wrap_mul(Rep a, Rep b) {
    return static_cast<Rep>(static_cast<Unsigned>(a) * static_cast<Unsigned>(b));
  }
  static Int alu(Rep value) {
    count(Op::IntAlu);
    return Int(value);
  }

  friend Int operator+(Int a, Int b) { return alu(wrap_add(a.v, b.v)); }
  friend Int operator-(Int a, Int b) { return alu(wrap_sub(a.v, b.v)); }
  friend Int operator-(Int a) { return alu(wrap_sub(0, a.v)); }
  friend Int operator&(Int a, Int b) { return alu(a.v & b.v); }
  friend Int operator|(Int a, Int b) { return alu(a.v | b.v); }
  friend Int operator^(Int a, Int b) { return alu(a.v ^ b.v); }
  friend Int operator~(Int a) { return alu(~a.v); }
  friend Int operator<<(Int a, int s) {
    return alu(static_cast<Rep>(static_cast<Unsigned>(a.v) << s));
  }
  friend Int operator>>(Int a, int s) { return alu(a.v >> s); }
  friend Int operator<<(Int a, Int<std::int32_t> s) { return a << s.v; }
  friend Int operator>>(Int a, Int<std::int32_t> s) { return a >> s.v; }
  friend Product<Int> operator*(Int a, Int b) { return Product<Int>(wrap_mul(a.v, b.v)); }
  /// Division by zero is defined, as it is on RISC-V: all ones, and the dividend as remainder.
  friend Int operator/(Int a, Int b) {
    count_division(b.v);
    return b.v == 0 ? Int(static_cast<Rep>(-1)) : Int(a.v / b.v);
  }
  friend Int operator%(Int a, Int b) {
    count_division(b.v);
    return b.v == 0 ? a : Int(a.v % b.v);
  }

  Int& operator+=(Int b) { return *this = *this + b; }
  Int& operator+=(Product<Int> b) { return *this = *this + b; }
  Int& operator-=(Int b) { return *this = *this - b; }
  Int& operator-=(Product<Int> b) { return *this = *this - b; }
  Int& operator*=(Int b) { return *this = *this * b; }
  Int& operator/=(Int b) { return *this = *this / b; }
  Int& operator&=(Int b) { return *this = *this & b; }
  Int& operator|=(Int b) { return *this = *this | b; }
  Int& operator^=(Int b) { return *this = *this ^ b; }
  Int& operator<<=(int s) { return *this = *this << s; }
  Int& operator>>=(int s) { return *this = *this >> s; }
  Int& operator++() { return *this += Int(1); }
  Int& operator--() { return *this -= Int(1); }

  friend Cond operator==(Int a, Int b) { return {a.v == b.v}; }
  friend Cond operator!=(Int a, Int b) { return {a.v != b.v}; }
  friend Cond operator<(Int a, Int b) { return {a.v < b.v}; }
  friend Cond operator<=(Int a, Int b) { return {a.v <= b.v}; }
  friend Cond operator>(Int a, Int b) { return {a.v > b.v}; }
  friend Cond operator>=(Int a, Int b) { return {a.v >= b.v}; }

 private:
  static void count_division(Rep divisor) {
    const auto magnitude = static_cast<Unsigned>(divisor < Rep{0} ? wrap_sub(0, divisor) : divisor);
    count(Op::IntDiv);
    count(Op::IntDivBits, static_cast<std::uint64_t>(std::countl_zero(magnitude)));
  }
};

/// Floating-point scalar that counts as the given operations.
template <class Rep, Op Add, Op Mul, Op Fma, Op Div, Op Compare, Op Sign>
struct Float {
  static constexpr Op kMul = Mul;
  static constexpr Op kMulAdd = Fma;
  static constexpr Op kSign = Sign;
  static constexpr Op kCompare = Compare;

  Rep v;

  Float() = default;
  constexpr Float(Rep value) : v(value) {}

  static constexpr Rep wrap_add(Rep a, Rep b) { return a + b; }
  static constexpr Rep wrap_sub(Rep a, Rep b) { return a - b; }
  static Cond compare(bool outcome) {
    count(Compare);
    return {outcome};
  }

  friend Float operator+(Float a, Float b) {
    count(Add);
    return Float(a.v + b.v);
  }
  friend Float operator-(Float a, Float b) {
    count(Add);
    return Float(a.v - b.v);
  }
  friend Float operator-(Float a) {
    count(Sign);
    return Float(-a.v);
  }
  friend Product<Float> operator*(Float a, Float b) { return Product<Float>(a.v * b.v); }
  friend Float operator/(Float a, Float b) {
    count(Div);
    return Float(a.v / b.v);
  }

  Float& operator+=(Float b) { return *this = *this + b; }
  Float& operator+=(Product<Float> b) { return *this = *this + b; }
  Float& operator-=(Float b) { return *this = *this - b; }
  Float& operator-=(Product<Float> b) { return *this = *this - b; }
  Float& operator*=(Float b) { return *this = *this * b; }
  Float& operator/=(Float b) { return *this = *this / b; }

  friend Cond operator==(Float a, Float b) { return compare(a.v == b.v); }
  friend Cond operator!=(Float a, Float b) { return compare(a.v != b.v); }
  friend Cond operator<(Float a, Float b) { return compare(a.v < b.v); }
  friend Cond operator<=(Float a, Float b) { return compare(a.v <= b.v); }
  friend Cond operator>(Float a, Float b) { return compare(a.v > b.v); }
  friend Cond operator>=(Float a, Float b) { return compare(a.v >= b.v); }
};

using I32 = Int<std::int32_t>;
using U32 = Int<std::uint32_t>;
using F32 =
    Float<float, Op::F32Add, Op::F32Mul, Op::F32Fma, Op::F32Div, Op::F32Compare, Op::F32Sign>;

/// Counts an operation that is a routine of a library on cores without hardware for it.
inline void count_routine(Op op, Routine routine) {
  count(op);
  code_events.call(routine);
}

/// Double precision. FP32-only cores emulate it in a library without a fused form, so a product
/// that is added counts as a product and a sum.
struct F64 {
  double v;

  F64() = default;
  constexpr F64(double value) : v(value) {}

  friend F64 operator+(F64 a, F64 b) {
    count_routine(Op::F64Add, Routine::F64Add);
    return F64(a.v + b.v);
  }
  friend F64 operator-(F64 a, F64 b) {
    count_routine(Op::F64Add, Routine::F64Sub);
    return F64(a.v - b.v);
  }
  friend F64 operator-(F64 a) {
    count(Op::IntAlu);
    return F64(-a.v);
  }
  friend F64 operator*(F64 a, F64 b) {
    count_routine(Op::F64Mul, Routine::F64Mul);
    return F64(a.v * b.v);
  }
  friend F64 operator/(F64 a, F64 b) {
    count_routine(Op::F64Div, Routine::F64Div);
    return F64(a.v / b.v);
  }
  F64& operator+=(F64 b) { return *this = *this + b; }
  F64& operator-=(F64 b) { return *this = *this - b; }
  F64& operator*=(F64 b) { return *this = *this * b; }
  F64& operator/=(F64 b) { return *this = *this / b; }
  friend Cond operator<(F64 a, F64 b) {
    count_routine(Op::F64Compare, Routine::F64Compare);
    return {a.v < b.v};
  }
  friend Cond operator>(F64 a, F64 b) {
    count_routine(Op::F64Compare, Routine::F64Compare);
    return {a.v > b.v};
  }
};

static_assert(sizeof(F32) == 4 && sizeof(I32) == 4 && sizeof(F64) == 8);
static_assert(std::is_trivial_v<F32> && std::is_trivial_v<I32> && std::is_trivial_v<F64>);

}  // namespace leviosim::work
