// Included before everything else when the workload is compiled for a target: the scopes of named
// functions leave marks in the code, so that a trace of addresses can be cut into named functions
// whatever the compiler inlined.
//
// A mark is one instruction without effect at the beginning of the function and one at its end: a
// HINT of 2 bytes on RV32 (c.li zero, imm), a nop of 2 bytes in Thumb code and of 4 in ARM code.
// Where they are, and for which function, stands in the section .leviosim_marks, which is not
// loaded. `asm inline` and no operands but constants: the mark neither counts as a long statement
// when the compiler decides what to inline nor holds a register.
#pragma once

#include "sim/work/policy.h"

#define LEVIOSIM_HOST_INLINE
#define LEVIOSIM_HOST_INLINED
#define LEVIOSIM_HOST_SHORTCUTS 0
// The compiler may not leave the range to the last of several assignments, as GCC 12 would.
#define LEVIOSIM_TARGET_BYTE(variable) \
  variable &= 0xff;                    \
  asm inline("" : "+r"(variable))
#define LEVIOSIM_TARGET_CALL [[gnu::noipa]]
extern "C" void* byte_memset(void* to, int value, std::size_t n);
#define LEVIOSIM_TARGET_CLEAR byte_memset

#ifdef __arm__
#define LEVIOSIM_MARK_BEGIN "nop\n"
#define LEVIOSIM_MARK_END "nop\n"
#define LEVIOSIM_MARK_NAMES "%c0, %c1"
#else
#define LEVIOSIM_MARK_BEGIN ".half 0x4005\n"
#define LEVIOSIM_MARK_END ".half 0x4009\n"
#define LEVIOSIM_MARK_NAMES "%0, %1"
#endif

namespace leviosim::work {

template <>
struct CodeScope<false> {
  /// @param source  the C++ function that the scope stands in; empty for a part of a function
  [[gnu::always_inline]] explicit CodeScope(CodeName name, const char* source = "") {
    asm volatile inline("7: " LEVIOSIM_MARK_BEGIN
                        ".pushsection .leviosim_marks,\"?\",%%progbits\n"
                        ".word 7b, " LEVIOSIM_MARK_NAMES
                        "\n"
                        ".popsection"
                        :
                        : "i"(name.text), "i"(source)
                        : "memory");
  }
  [[gnu::always_inline]] ~CodeScope() {
    asm volatile inline("7: " LEVIOSIM_MARK_END
                        ".pushsection .leviosim_marks,\"?\",%%progbits\n"
                        ".word 7b, 0, 0\n"
                        ".popsection" ::
                            : "memory");
  }
  CodeScope(const CodeScope&) = delete;
  CodeScope& operator=(const CodeScope&) = delete;
};

template <>
struct FunctionScope<false> {
  [[gnu::always_inline]] explicit FunctionScope(CodeName name,
                                                const char* source = __builtin_FUNCTION())
      : code_(name, source) {}
  [[gnu::always_inline]] ~FunctionScope() = default;

 private:
  CodeScope<false> code_;
};

}  // namespace leviosim::work
