#include "traces/work_traces/byte_stream.h"

#include <fmt/core.h>

#include "sim/base/error.h"

namespace leviosim::traces {

std::uint64_t ByteReader::fixed(int size, const char* what) {
  const std::string_view bytes = take(static_cast<std::size_t>(size), what);
  std::uint64_t value = 0;
  for (int i = size - 1; i >= 0; --i)
    value = value << 8 | static_cast<std::uint8_t>(bytes[static_cast<std::size_t>(i)]);
  return value;
}

std::uint64_t ByteReader::long_whole(const char* what) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    const std::uint64_t next = byte(what);
    if (shift == 63 && next > 1) break;
    value |= (next & 0x7f) << shift;
    if (next < 0x80) return value;
  }
  fail(fmt::format("{} has more than 64 bits", what));
}

void ByteReader::expect_end() {
  if (left() > 0) fail(fmt::format("expected the end, found {} more bytes", left()));
}

void ByteReader::fail(std::string_view message) const {
  throw InputError(fmt::format("{}, byte {}: {}", *place_, position(), message));
}

void ByteReader::fail_end(const char* what) const {
  fail(fmt::format("expected {}, found the end", what));
}

void ByteReader::fail_limit(const char* what, std::uint64_t value, std::uint64_t limit) const {
  if (limit == 0) fail(fmt::format("{} is {}; expected none", what, value));
  fail(fmt::format("{} is {}; expected 0 to {}", what, value, limit - 1));
}

void ByteReader::fail_budget(std::size_t number, std::size_t each, const char* what) const {
  fail(budget_->refusal(fmt::format("{} ({})", what, number), number * each));
}

}  // namespace leviosim::traces
