// A file of track events as Perfetto's page opens it: tracks, and slices, instants and counters on
// them. Knows the format, not what is shown.
//
// A file is a sequence of packets of one writer. Names are written once and referred to by number.
// Slices of a track nest: one that is begun within another ends before it. Bytes that cannot be
// shown are escaped.
//
// Source: perfetto.dev, protos/perfetto/trace/track_event/.
#pragma once

#include <bit>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace leviosim::tools {

// Writes messages of Protocol Buffers: the wire types that Perfetto's traces need. The meaning of
// the fields is the caller's.

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

enum class CounterUnit : std::uint8_t { Milliwatts, Bytes };

/// How a track is found and where it stands. Numbers are the caller's, from 1.
struct Track {
  std::uint64_t number = 0;
  std::string_view name;
  std::uint64_t parent = 0;  ///< 0: none
  int rank = 0;              ///< among those of its parent
};

/// A value beside a slice or an instant. Names and texts are copied.
struct Annotation {
  std::string_view name;
  std::variant<bool, std::int64_t, double, std::string_view> value;
};

/// A name, and what goes with it.
struct EventText {
  std::string_view name;
  bool is_unique = false;  ///< the name occurs once and is not kept for later
  std::vector<Annotation> annotations = {};
  std::vector<std::uint64_t> flows = {};  ///< arrows that begin here or go on
  std::vector<std::uint64_t> ends = {};   ///< arrows that end here
};

class TrackEventWriter {
 public:
  /// The track of all others, as a process.
  void add_root(const Track& track);
  void add_track(const Track& track);
  void add_counter_track(const Track& track, CounterUnit unit);

  /// Times are in ns, and do not fall on a track.
  void begin(std::uint64_t track, std::int64_t time_ns, const EventText& text);
  void end(std::uint64_t track, std::int64_t time_ns);
  void instant(std::uint64_t track, std::int64_t time_ns, const EventText& text);
  void counter(std::uint64_t track, std::int64_t time_ns, std::int64_t value);
  void counter(std::uint64_t track, std::int64_t time_ns, double value);

  /// To write anew what came after a moment.
  struct Mark {
    std::size_t bytes = 0;
    std::map<std::string, std::uint64_t, std::less<>> names;
    std::map<std::string, std::uint64_t, std::less<>> annotations;
  };
  Mark mark() const { return {bytes_.size(), names_, annotation_names_}; }
  void rewind(const Mark& mark);
  std::size_t size() const { return bytes_.size(); }

  const std::string& bytes() const { return bytes_; }

 private:
  using Names = std::map<std::string, std::uint64_t, std::less<>>;

  void add_event(int type, std::uint64_t track, std::int64_t time_ns, const EventText& text);
  /// @param names  that the event is the first to use; null if it uses none
  void add_packet(std::int64_t time_ns, const ProtobufWriter& event, const ProtobufWriter* names);
  void add_descriptor(const ProtobufWriter& descriptor);
  static std::uint64_t number_of(std::string_view name, Names& known, int field,
                                 ProtobufWriter& added);

  std::string bytes_;
  Names names_;
  Names annotation_names_;
  bool is_first_ = true;
};

}  // namespace leviosim::tools
