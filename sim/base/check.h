// Assertions of internal invariants, active in every build type. They name both values.
#pragma once

#include <fmt/core.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace leviosim {

/// A place in the source. The builtins stand in for std::source_location, which Clang 14 lacks.
struct SourceLine {
  const char* file;
  int line;
  static constexpr SourceLine current(const char* file = __builtin_FILE(),
                                      int line = __builtin_LINE()) {
    return {file, line};
  }
};

[[noreturn]] inline void check_failed(std::string_view message, SourceLine where) {
  fmt::print(stderr, "leviosim: internal fault at {}:{}: {}\n", where.file, where.line, message);
  std::abort();
}

/// Aborts unless `ok`.
inline void check(bool ok, std::string_view message, SourceLine where = SourceLine::current()) {
  if (!ok) [[unlikely]]
    check_failed(message, where);
}

/// Aborts unless `actual == expected`, printing both.
template <class A, class B>
void check_equal(const A& actual, const B& expected, std::string_view what,
                 SourceLine where = SourceLine::current()) {
  if (!(actual == expected)) [[unlikely]]
    check_failed(fmt::format("{}: is {}, expected {}", what, actual, expected), where);
}

}  // namespace leviosim
