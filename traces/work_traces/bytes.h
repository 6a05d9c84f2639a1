// Bytes of binary files, written and read in order. Numbers are little-endian; a *whole number* is
// a LEB128 varint (seven bits a byte, the lowest first), signed ones are zigzag-mapped before.
//
// A reader never reads beyond its end: every fault is an InputError that names the place.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "traces/work_traces/memory_budget.h"

namespace leviosim::traces {

class ByteWriter {
 public:
  void byte(std::uint8_t value) { bytes_.push_back(static_cast<char>(value)); }
  void u32(std::uint32_t value) { fixed(value, 4); }
  void u64(std::uint64_t value) { fixed(value, 8); }
  void f64(double value) { u64(std::bit_cast<std::uint64_t>(value)); }
  void whole(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) byte(static_cast<std::uint8_t>(value | 0x80));
    byte(static_cast<std::uint8_t>(value));
  }
  void integer(std::int64_t value) {
    whole((static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63));
  }
  /// Length, then the bytes.
  void text(std::string_view value) {
    whole(value.size());
    bytes_.append(value);
  }
  void append(std::string_view bytes) { bytes_.append(bytes); }

  std::size_t size() const { return bytes_.size(); }
  const std::string& bytes() const { return bytes_; }
  std::string take() { return std::move(bytes_); }

 private:
  void fixed(std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i) byte(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  std::string bytes_;
};

class ByteReader {
 public:
  ByteReader() = default;
  /// @param bytes  outlive the reader, as does `place`
  /// @param place  what these bytes are, e.g. "out/work.trace, frames 0 to 31"
  /// @param budget  pays for what they stand for; outlives the reader, too
  ByteReader(std::string_view bytes, const std::string& place, MemoryBudget* budget = nullptr)
      : begin_(bytes.data()),
        at_(begin_),
        end_(begin_ + bytes.size()),
        place_(&place),
        budget_(budget) {}

  std::uint8_t byte(const char* what) {
    if (at_ == end_) [[unlikely]]
      fail_end(what);
    return static_cast<std::uint8_t>(*at_++);
  }
  std::uint32_t u32(const char* what) { return static_cast<std::uint32_t>(fixed(4, what)); }
  std::uint64_t u64(const char* what) { return fixed(8, what); }
  double f64(const char* what) { return std::bit_cast<double>(u64(what)); }
  std::uint64_t whole(const char* what) {
    if (at_ != end_ && !(*at_ & 0x80)) [[likely]]
      return static_cast<std::uint8_t>(*at_++);
    return long_whole(what);
  }
  std::int64_t integer(const char* what) {
    const std::uint64_t value = whole(what);
    return static_cast<std::int64_t>((value >> 1) ^ (0 - (value & 1)));
  }
  /// A whole number from 0 to below `limit`, of which `what` says what it is.
  std::uint64_t whole_below(std::uint64_t limit, const char* what) {
    const std::uint64_t value = whole(what);
    if (value >= limit) [[unlikely]]
      fail_limit(what, value, limit);
    return value;
  }
  /// How many things follow that take at least a byte each here, and so much memory each when they
  /// are read: the budget pays for them. @throws InputError if it does not suffice
  std::size_t count(const char* what, std::size_t memory_each) {
    const auto number = static_cast<std::size_t>(whole_below(left() + 1, what));
    charge(number, memory_each, what);
    return number;
  }
  /// The budget pays for things that are not counted in the file.
  void charge(std::size_t number, std::size_t memory_each, const char* what) {
    if (budget_ != nullptr && !budget_->take(number * memory_each)) [[unlikely]]
      fail_budget(number, memory_each, what);
  }
  std::string_view text(const char* what) { return take(count(what, 1), what); }
  std::string_view take(std::size_t size, const char* what) {
    if (size > left()) fail_end(what);
    const std::string_view bytes(at_, size);
    at_ += size;
    return bytes;
  }

  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  std::size_t position() const { return static_cast<std::size_t>(at_ - begin_); }
  const std::string& place() const { return *place_; }
  MemoryBudget* budget() const { return budget_; }
  /// @throws InputError if something is left
  void expect_end();
  /// @throws InputError "PLACE, byte N: MESSAGE"
  [[noreturn]] void fail(std::string_view message) const;

 private:
  std::uint64_t fixed(int size, const char* what);
  std::uint64_t long_whole(const char* what);
  [[noreturn]] void fail_end(const char* what) const;
  [[noreturn]] void fail_limit(const char* what, std::uint64_t value, std::uint64_t limit) const;
  [[noreturn]] void fail_budget(std::size_t number, std::size_t each, const char* what) const;

  const char* begin_ = nullptr;
  const char* at_ = nullptr;
  const char* end_ = nullptr;
  const std::string* place_ = nullptr;
  MemoryBudget* budget_ = nullptr;
};

}  // namespace leviosim::traces
