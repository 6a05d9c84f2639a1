// The two arithmetic policies that kernels are templates over.
//
//   template <class P> typename P::F32 dot(typename P::template Span<const typename P::F32> a, …) {
//     typename P::F32 sum = 0.0f;
//     for (int i : P::range(0, a.size())) sum += a[i] * b[i];
//     return sum;
//   }
//
// Native: the types *are* float, std::int32_t, std::uint8_t… Counting: thin wrappers that also
// count. Both compute the same bits. Nobody writes operation counts by hand: loops are written with
// P::range, functions that are real calls on the target start with `typename P::Function`, large
// bodies of loops with `typename P::Code`.
#pragma once

#include <cstdint>

#include "sim/work/code_events.h"
#include "sim/work/counted.h"
#include "sim/work/functions.h"
#include "sim/work/loops.h"
#include "sim/work/memory.h"
#include "sim/work/offload_regions.h"

namespace leviosim::work {

/// Marks a stretch of code, so that the size of its compiled form is known by its name
/// (code_map.h): the body of a loop that calls nothing and is large. Costs nothing by itself.
template <bool Counted>
struct CodeScope {
  explicit CodeScope(CodeName name) {
    if constexpr (Counted) code_events.enter(name);
  }
  ~CodeScope() {
    if constexpr (Counted) code_events.leave();
  }
  CodeScope(const CodeScope&) = delete;
  CodeScope& operator=(const CodeScope&) = delete;
};

/// Marks a function that a target compiler does not inline: names its code, and counts a call.
template <bool Counted>
struct FunctionScope {
  explicit FunctionScope(CodeName name) : code_(name) {
    if constexpr (Counted) count(Op::Call);
  }

 private:
  CodeScope<Counted> code_;
};

struct Native {
  static constexpr bool kCounting = false;
  using F32 = float;
  using F64 = double;
  using I32 = std::int32_t;
  using U32 = std::uint32_t;
  using U16 = std::uint16_t;
  using Byte = std::uint8_t;
  using Bool = bool;
  template <class T>
  using Span = NativeSpan<T>;
  template <class T>
  using L2Span = NativeSpan<T>;
  template <class T>
  using SharedSpan = NativeSpan<T>;
  template <class T>
  using EitherSpan = NativeSpan<T>;
  template <class T, int N>
  using Array = NativeArray<T, N>;
  using Function = FunctionScope<false>;
  using Code = CodeScope<false>;
  using OffloadRegion = OffloadScope<false>;
  /// A jump through a table: of a state machine, an interpreter.
  static void jump_to_computed() {}
  static Range<false> range(int begin, int end) { return {begin, end}; }
  static ByteRange<false> byte_range(int begin, int end) { return {begin, end}; }
  static DownRange<false> down_range(int begin, int last) { return {begin, last - 1}; }
};

struct Counting {
  static constexpr bool kCounting = true;
  using F32 = work::F32;
  using F64 = work::F64;
  using I32 = work::I32;
  using U32 = work::U32;
  using U16 = std::uint16_t;
  using Byte = work::Byte;
  using Bool = Cond;
  template <class T>
  using Span = CountedSpan<T>;
  template <class T>
  using L2Span = CountedSpan<T, Space::L2>;
  template <class T>
  using SharedSpan = CountedSpan<T, Space::Shared>;
  /// Of what lies in L2 where local memory has no room for it.
  template <class T>
  using EitherSpan = CountedSpan<T, Space::Either>;
  template <class T, int N>
  using Array = CountedArray<T, N>;
  using Function = FunctionScope<true>;
  using Code = CodeScope<true>;
  using OffloadRegion = OffloadScope<true>;
  static void jump_to_computed() { count(Op::JumpRegister); }
  static Range<true> range(int begin, int end) { return {begin, end}; }
  static ByteRange<true> byte_range(int begin, int end) { return {begin, end}; }
  static DownRange<true> down_range(int begin, int last) { return {begin, last - 1}; }
  static Range<true> range(I32 begin, I32 end) { return {begin.v, end.v}; }
};

}  // namespace leviosim::work
