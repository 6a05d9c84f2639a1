// What runtime.cpp needs to know of RV32 under Linux: calls of the system, threads, the entry.
#pragma once

#include <cstdint>

namespace leviosim::rv32 {

inline std::int32_t system_call(std::int32_t number, std::int32_t a, std::int32_t b,
                                std::int32_t c) {
  register std::int32_t a0 asm("a0") = a;
  register std::int32_t a1 asm("a1") = b;
  register std::int32_t a2 asm("a2") = c;
  register std::int32_t a7 asm("a7") = number;
  asm volatile("ecall" : "+r"(a0) : "r"(a1), "r"(a2), "r"(a7) : "memory");
  return a0;
}

inline constexpr std::int32_t kWrite = 64, kExit = 93;

inline void begin_thread(unsigned char* storage) { asm volatile("mv tp, %0" : : "r"(storage)); }

}  // namespace leviosim::rv32

asm(".globl _start\n"
    "_start:\n"
    ".option push\n.option norelax\n"
    "la gp, __global_pointer$\n"
    ".option pop\n"
    "andi sp, sp, -16\n"
    "call start_program\n");
