// What a C++ program needs to run under QEMU without an operating system's libraries: an
// entry, memory, and output. Debian has no C++ library for this target; what only error paths need
// (exceptions, fmt) stays unresolved and is address 0.
#include <cstddef>
#include <cstdint>

#ifdef __arm__
#include "tools/rv32/target/arm.h"
#else
#include "tools/rv32/target/riscv.h"
#endif
#include "tools/rv32/runtime.h"

namespace {

using leviosim::rv32::begin_thread;
using leviosim::rv32::kExit;
using leviosim::rv32::kWrite;
using leviosim::rv32::system_call;

constexpr std::size_t kHeapBytes = std::size_t{256} << 20;
alignas(16) unsigned char heap[kHeapBytes];
std::size_t heap_used = 0;

}  // namespace

int main();
using Initialiser = void (*)();
extern "C" Initialiser __init_array_start[], __init_array_end[];

extern "C" {

alignas(16) unsigned char thread_storage[4096];

[[noreturn]] void exit_program(std::int32_t status) {
  for (;;) system_call(kExit, status, 0, 0);
}

[[gnu::used]] void start_program() {
  begin_thread(thread_storage);
  for (Initialiser* i = __init_array_start; i != __init_array_end; ++i) (*i)();
  exit_program(main());
}

[[noreturn]] void abort() noexcept { exit_program(3); }
[[noreturn]] void __cxa_pure_virtual() { exit_program(4); }
int __cxa_atexit(void (*)(void*), void*, void*) { return 0; }
void* __dso_handle = nullptr;

// Word by word where both sides allow it, as embedded C libraries do. (What clears byte by byte
// calls byte_memset, which the Makefile takes from the C library.)
void* memcpy(void* to, const void* from, std::size_t n) noexcept {
  auto* d = static_cast<unsigned char*>(to);
  auto* s = static_cast<const unsigned char*>(from);
  const bool words =
      ((reinterpret_cast<std::uintptr_t>(d) | reinterpret_cast<std::uintptr_t>(s)) & 3) == 0;
  if (words)
    for (; n >= 4; n -= 4, d += 4, s += 4)
      *reinterpret_cast<std::uint32_t*>(d) = *reinterpret_cast<const std::uint32_t*>(s);
  for (; n > 0; --n) *d++ = *s++;
  return to;
}

void* memmove(void* to, const void* from, std::size_t n) noexcept {
  auto* d = static_cast<unsigned char*>(to);
  auto* s = static_cast<const unsigned char*>(from);
  if (d <= s || d >= s + n) return memcpy(to, from, n);
  while (n-- > 0) d[n] = s[n];
  return to;
}

void* memset(void* to, int value, std::size_t n) noexcept {
  auto* d = static_cast<unsigned char*>(to);
  const std::uint32_t word = 0x01010101u * static_cast<unsigned char>(value);
  for (; n > 0 && (reinterpret_cast<std::uintptr_t>(d) & 3) != 0; --n)
    *d++ = static_cast<unsigned char>(value);
  for (; n >= 4; n -= 4, d += 4) *reinterpret_cast<std::uint32_t*>(d) = word;
  for (; n > 0; --n) *d++ = static_cast<unsigned char>(value);
  return to;
}

int memcmp(const void* a, const void* b, std::size_t n) noexcept {
  auto* x = static_cast<const unsigned char*>(a);
  auto* y = static_cast<const unsigned char*>(b);
  for (; n > 0; --n, ++x, ++y)
    if (*x != *y) return *x - *y;
  return 0;
}

std::size_t strlen(const char* s) noexcept {
  std::size_t n = 0;
  while (s[n] != 0) ++n;
  return n;
}

}  // extern "C"

void* operator new(std::size_t n) {
  const std::size_t begin = heap_used;
  heap_used += (n + 15) & ~std::size_t{15};
  if (heap_used > kHeapBytes) exit_program(5);
  return heap + begin;
}
void* operator new[](std::size_t n) { return operator new(n); }
void operator delete(void*) noexcept {}
void operator delete[](void*) noexcept {}
void operator delete(void*, std::size_t) noexcept {}
void operator delete[](void*, std::size_t) noexcept {}

namespace leviosim::rv32 {

void write_text(const char* text) {
  system_call(kWrite, 2, static_cast<std::int32_t>(reinterpret_cast<std::intptr_t>(text)),
              static_cast<std::int32_t>(strlen(text)));
}

}  // namespace leviosim::rv32
