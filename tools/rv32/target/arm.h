// What runtime.cpp needs to know of ARM under Linux: calls of the system, threads, the entry.
#pragma once

#include <cstdint>

namespace leviosim::rv32 {

inline std::int32_t system_call(std::int32_t number, std::int32_t a, std::int32_t b,
                                std::int32_t c) {
  register std::int32_t r0 asm("r0") = a;
  register std::int32_t r1 asm("r1") = b;
  register std::int32_t r2 asm("r2") = c;
  register std::int32_t r7 asm("r7") = number;
  asm volatile("svc 0" : "+r"(r0) : "r"(r1), "r"(r2), "r"(r7) : "memory");
  return r0;
}

inline constexpr std::int32_t kWrite = 4, kExit = 1;

inline void begin_thread(unsigned char*) {}

}  // namespace leviosim::rv32

// Where compiled code asks for the variables of its thread, which lie 8 bytes further on. It may
// change no register but r0.
asm(".globl __aeabi_read_tp\n"
    ".type __aeabi_read_tp, %function\n"
    "__aeabi_read_tp:\n"
    "ldr r0, 1f\n"
    "bx lr\n"
    ".balign 4\n"
    "1: .word thread_storage\n"
    ".size __aeabi_read_tp, . - __aeabi_read_tp\n");

asm(".globl _start\n"
    ".type _start, %function\n"
    "_start:\n"
    "mov r0, sp\n"
    "bic r0, r0, #15\n"
    "mov sp, r0\n"
    "bl start_program\n");
