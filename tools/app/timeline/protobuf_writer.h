// Writes messages of Protocol Buffers: the wire types that Perfetto's traces need. The meaning of
// the fields is the caller's.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>


namespace leviosim::tools {

class ProtobufWriter {
 public:
  void add_uint(int field, std::uint64_t value) {
    add_tag(field, kVarint);
    add_varint(value);
  }
  void add_bool(int field, bool value) { add_uint(field, value ? 1 : 0); }
  void add_double(int field, double value) {
    add_tag(field, kFixed64);
    add_eight_bytes(std::bit_cast<std::uint64_t>(value));
  }
  void add_fixed64(int field, std::uint64_t value) {
    add_tag(field, kFixed64);
    add_eight_bytes(value);
  }
  /// A string, or a message that is complete.
  void add_bytes(int field, std::string_view bytes) {
    add_tag(field, kLengthDelimited);
    add_varint(bytes.size());
    bytes_.append(bytes);
  }
  void add_message(int field, const ProtobufWriter& message) { add_bytes(field, message.bytes_); }

  const std::string& bytes() const { return bytes_; }

 private:
  static constexpr unsigned kVarint = 0;
  static constexpr unsigned kFixed64 = 1;
  static constexpr unsigned kLengthDelimited = 2;

  void add_tag(int field, unsigned wire_type) {
    add_varint(static_cast<std::uint64_t>(field) << 3 | wire_type);
  }
  /// Seven bits a byte, the lowest first; all bytes but the last have the top bit set.
  void add_varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_ += static_cast<char>((value & 0x7f) | 0x80);
    bytes_ += static_cast<char>(value);
  }
  void add_eight_bytes(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) bytes_ += static_cast<char>(value >> shift & 0xff);
  }

  std::string bytes_;
};

}  // namespace leviosim::tools
