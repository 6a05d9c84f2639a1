// What becomes of an exception: its text goes to the page, which ends the call (page/engine.js).
// Debian's C++ library for wasm32 cannot throw, and nothing in the engine catches: the stack is not
// unwound, so what the call had allocated is lost, some kilobytes for a setting that cannot be.
#include <cstdlib>
#include <cstring>
#include <exception>
#include <typeinfo>

extern "C" {

/// Of the page; does not return.
__attribute__((import_module("page"), import_name("fail"))) void page_fail(const char* text,
                                                                           std::size_t size);

void* __cxa_allocate_exception(std::size_t size) noexcept { return std::malloc(size); }

/// All that the program throws are std::exceptions.
[[noreturn]] void __cxa_throw(void* thrown, std::type_info*, void (*)(void*)) {
  const char* const text = static_cast<std::exception*>(thrown)->what();
  page_fail(text, std::strlen(text));
  std::abort();
}

}  // extern "C"
