// A file of track events as Perfetto's page opens it: tracks, and slices, instants and counters on
// them. Knows the format, not what is shown.
//
// A file is a sequence of packets of one writer. Names are written once and referred to by number.
// Slices of a track nest: one that is begun within another ends before it. Bytes that cannot be
// shown are escaped.
//
// Source: perfetto.dev, protos/perfetto/trace/track_event/.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "tools/app/timeline/protobuf_writer.h"

namespace leviosim::tools {

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

  /// What has been written since the last call.
  std::string take() { return std::exchange(bytes_, {}); }

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
