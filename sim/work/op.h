// The kinds of operation that counted scalars record: the part of the work vocabulary that says
// what a core does. An Op is an operation of the *source program*; what it costs on a chip
// (instructions, stalls, which shared unit it occupies) is the platform's business
// (platform_models/).
//
// Left out: register moves, spills and address constants, which a compiler adds; platforms carry
// one global code-generation overhead for them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "sim/work/counts.h"

namespace leviosim::work {

enum class Op : std::uint8_t {
  IntAlu,
  IntAddShift,
  IntMinMax,
  IntMul,
  IntMac,
  IntMulHigh,
  IntDiv,
  IntDivBits,
  Popcount,
  LoadStream,
  LoadIndexed,
  StoreStream,
  StoreIndexed,
  LoadL2,
  StoreL2,
  LoadShared,
  StoreShared,
  Straddle,
  BranchTaken,
  BranchNotTaken,
  LoopEntry,
  LoopIteration,
  LoopJump,
  Call,
  JumpRegister,
  F32Add,
  F32Mul,
  F32Fma,
  F32Div,
  F32Sqrt,
  F32Compare,
  F32Convert,
  F32Sign,
  F64Add,
  F64Mul,
  F64Div,
  F64Compare,
  F64Convert,
  F16Op,
  F16Div,
  SimdAlu,
  SimdMinMax,
  SimdDot,
  SimdSad,
  SimdAverage,
  Int64Add,
  Int64Mul,
  Int64Mac,
};

inline constexpr std::array kOps = {
    OpInfo{Op::IntAlu, "int_alu", "integer add, subtract, logic, shift, negate"},
    OpInfo{Op::IntAddShift, "int_add_shift", "integer sum or difference that is shifted right"},
    OpInfo{Op::IntMinMax, "int_min_max", "integer minimum, maximum, absolute value"},
    OpInfo{Op::IntMul, "int_mul", "32-bit integer product"},
    OpInfo{Op::IntMac, "int_mac", "32-bit integer product added to or subtracted from a value"},
    OpInfo{Op::IntMulHigh, "int_mul_high", "upper half of a 32-bit integer product"},
    OpInfo{Op::IntDiv, "int_div", "integer quotient or remainder"},
    OpInfo{Op::IntDivBits, "int_div_bits", "leading zeros of the divisors, summed over int_div"},
    OpInfo{Op::Popcount, "popcount", "number of set bits of a 32-bit word"},
    OpInfo{Op::LoadStream, "load_stream", "load whose address is affine in the loop indices"},
    OpInfo{Op::LoadIndexed, "load_indexed", "load whose address is computed from data"},
    OpInfo{Op::StoreStream, "store_stream", "store whose address is affine in the loop indices"},
    OpInfo{Op::StoreIndexed, "store_indexed", "store whose address is computed from data"},
    OpInfo{Op::LoadL2, "load_l2", "load from L2 by a core whose own memory is L1"},
    OpInfo{Op::StoreL2, "store_l2", "store to L2 by a core whose own memory is L1"},
    OpInfo{Op::LoadShared, "load_shared", "load of a word that all cores use at the same time"},
    OpInfo{Op::StoreShared, "store_shared", "store to a word that all cores use at the same time"},
    OpInfo{Op::Straddle, "straddle", "access crossing a word, counted besides its load or store"},
    OpInfo{Op::BranchTaken, "branch_taken", "conditional branch that is taken"},
    OpInfo{Op::BranchNotTaken, "branch_not_taken", "conditional branch that falls through"},
    OpInfo{Op::LoopEntry, "loop_entry", "counted loop entered"},
    OpInfo{Op::LoopIteration, "loop_iteration", "iteration of a counted loop"},
    OpInfo{Op::LoopJump, "loop_jump",
           "iteration of a loop around two others, calls or branches, counted besides"},
    OpInfo{Op::Call, "call", "call of a function that is not inlined, with its return"},
    OpInfo{Op::JumpRegister, "jump_register", "jump to an address that was computed just before"},
    OpInfo{Op::F32Add, "f32_add", "single-precision sum or difference"},
    OpInfo{Op::F32Mul, "f32_mul", "single-precision product"},
    OpInfo{Op::F32Fma, "f32_fma", "single-precision product added to or subtracted from a value"},
    OpInfo{Op::F32Div, "f32_div", "single-precision quotient"},
    OpInfo{Op::F32Sqrt, "f32_sqrt", "single-precision square root"},
    OpInfo{Op::F32Compare, "f32_compare", "single-precision comparison"},
    OpInfo{Op::F32Convert, "f32_convert", "conversion between single precision and integer"},
    OpInfo{Op::F32Sign, "f32_sign", "single-precision negation, absolute value, minimum, maximum"},
    OpInfo{Op::F64Add, "f64_add", "double-precision sum or difference"},
    OpInfo{Op::F64Mul, "f64_mul", "double-precision product"},
    OpInfo{Op::F64Div, "f64_div", "double-precision quotient"},
    OpInfo{Op::F64Compare, "f64_compare", "double-precision comparison"},
    OpInfo{Op::F64Convert, "f64_convert", "conversion between single and double precision"},
    OpInfo{Op::F16Op, "f16_op", "half-precision sum, product, multiply-add or conversion"},
    OpInfo{Op::F16Div, "f16_div", "half-precision quotient"},
    OpInfo{Op::SimdAlu, "simd_alu", "sum, difference, shuffle of 2x16 or 4x8 bit packed integers"},
    OpInfo{Op::SimdMinMax, "simd_min_max", "minimum, maximum of 2x16 or 4x8 bit packed integers"},
    OpInfo{Op::SimdDot, "simd_dot", "dot product of 2x16 or 4x8 bits, added to a sum or not"},
    OpInfo{Op::SimdSad, "simd_sad", "absolute differences of 4x8 bits added to a sum"},
    OpInfo{Op::SimdAverage, "simd_average", "means of 4x8 bit packed integers, rounded down"},
    OpInfo{Op::Int64Add, "int64_add", "64-bit integer sum or difference"},
    OpInfo{Op::Int64Mul, "int64_mul", "64-bit product of 32-bit integers"},
    OpInfo{Op::Int64Mac, "int64_mac", "64-bit product of 32-bit integers added to a 64-bit value"},
};

static_assert(kOps.size() == kOpCount, "counts.h says how many kinds of operation there are");

constexpr bool ops_are_in_order() {
  for (std::size_t i = 0; i < kOpCount; ++i)
    if (index(kOps[i].op) != i) return false;
  return true;
}
static_assert(ops_are_in_order(), "kOps must list every Op in the order of the enumeration");

}  // namespace leviosim::work
