// Reads a file of track events as Perfetto does, written from the format's description and not
// from the writer: wire types of Protocol Buffers, interned names, stacks of slices. Throws where
// a file is not what the format asks for.
#pragma once

#include <bit>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace leviosim::tests {

/// A field of a message: a number, or bytes.
struct ProtoField {
  int number = 0;
  std::uint64_t value = 0;
  std::string_view bytes;

  double real() const { return std::bit_cast<double>(value); }
};

class ProtoReader {
 public:
  explicit ProtoReader(std::string_view bytes) : left_(bytes) {}

  std::optional<ProtoField> next() {
    if (left_.empty()) return std::nullopt;
    const std::uint64_t tag = varint();
    ProtoField field;
    field.number = static_cast<int>(tag >> 3);
    switch (tag & 7) {
      case 0:
        field.value = varint();
        break;
      case 1:
        for (unsigned i = 0; const char c : take(8))
          field.value |= std::uint64_t{static_cast<unsigned char>(c)} << (8 * i++);
        break;
      case 2:
        field.bytes = take(varint());
        break;
      default:
        throw std::runtime_error("a wire type that is not used");
    }
    if (field.number == 0) throw std::runtime_error("a field without a number");
    return field;
  }

 private:
  std::string_view take(std::size_t n) {
    if (n > left_.size()) throw std::runtime_error("a message ends early");
    const std::string_view taken = left_.substr(0, n);
    left_.remove_prefix(n);
    return taken;
  }
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const auto byte = static_cast<unsigned char>(take(1)[0]);
      value |= std::uint64_t{byte & 0x7fu} << shift;
      if (byte < 0x80) return value;
    }
    throw std::runtime_error("a number of more than 64 bits");
  }

  std::string_view left_;
};

struct PerfettoTrack {
  std::string name;
  std::uint64_t parent = 0;
  int rank = -1;
  bool is_counter = false;
};

/// A slice with its end, an instant or a counter's value.
struct PerfettoEvent {
  enum Type : int { kNone, kBegin, kEnd, kInstant, kCounter };
  int type = kNone;
  std::uint64_t track = 0;
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
  int depth = 0;  ///< slices of the track around it
  std::string name;
  std::map<std::string, double> numbers;  ///< annotations
  std::map<std::string, std::string> texts;
  std::vector<std::uint64_t> flows;
  std::vector<std::uint64_t> flow_ends;
  double value = 0;  ///< of a counter

  double number(const std::string& key) const {
    const auto it = numbers.find(key);
    return it == numbers.end() ? 0 : it->second;
  }
};

class PerfettoTrace {
 public:
  explicit PerfettoTrace(std::string_view file) {
    ProtoReader reader(file);
    while (const auto field = reader.next()) {
      if (field->number != 1) throw std::runtime_error("a trace holds packets only");
      read_packet(field->bytes);
    }
    for (const auto& [track, stack] : open_)
      if (!stack.empty()) throw std::runtime_error("a slice without an end");
  }

  const std::map<std::uint64_t, PerfettoTrack>& tracks() const { return tracks_; }
  const std::vector<PerfettoEvent>& events() const { return events_; }
  std::uint64_t track(const std::string& name) const {
    for (const auto& [number, track] : tracks_)
      if (track.name == name) return number;
    throw std::runtime_error("there is no track " + name);
  }
  std::vector<PerfettoEvent> on(const std::string& name) const {
    std::vector<PerfettoEvent> found;
    for (const PerfettoEvent& event : events_)
      if (event.track == track(name)) found.push_back(event);
    return found;
  }

 private:
  using Names = std::map<std::uint64_t, std::string>;

  void read_packet(std::string_view bytes) {
    std::uint64_t flags = 0;
    std::optional<std::uint64_t> time;
    bool has_sequence = false;
    std::string_view event;
    ProtoReader reader(bytes);
    while (const auto field = reader.next()) {
      if (field->number == 8) time = field->value;
      if (field->number == 10) has_sequence = field->value != 0;
      if (field->number == 13) flags = field->value;
      if (field->number == 60) read_track(field->bytes);
      if (field->number == 12) read_names(field->bytes);
      if (field->number == 11) event = field->bytes;
    }
    if ((flags & 1) != 0) is_cleared_ = true;
    if (!has_sequence || !is_cleared_) throw std::runtime_error("a sequence without its start");
    if (event.empty()) return;
    if (!time) throw std::runtime_error("an event without a time");
    read_event(event, static_cast<std::int64_t>(*time), (flags & 2) != 0);
  }

  void read_track(std::string_view bytes) {
    std::uint64_t number = 0;
    PerfettoTrack track;
    ProtoReader reader(bytes);
    while (const auto field = reader.next()) {
      if (field->number == 1) number = field->value;
      if (field->number == 2) track.name = field->bytes;
      if (field->number == 5) track.parent = field->value;
      if (field->number == 8) track.is_counter = true;
      if (field->number == 12) track.rank = static_cast<int>(field->value);
    }
    if (!tracks_.emplace(number, track).second) throw std::runtime_error("a track comes twice");
    if (track.parent != 0 && tracks_.count(track.parent) == 0)
      throw std::runtime_error("a track without its parent");
  }

  void read_names(std::string_view bytes) {
    ProtoReader reader(bytes);
    while (const auto field = reader.next()) {
      Names& names = field->number == 2 ? event_names_ : annotation_names_;
      std::uint64_t number = 0;
      std::string name;
      ProtoReader entry(field->bytes);
      while (const auto part = entry.next()) {
        if (part->number == 1) number = part->value;
        if (part->number == 2) name = part->bytes;
      }
      if (!names.emplace(number, name).second) throw std::runtime_error("a name comes twice");
    }
  }

  static const std::string& name_in(const Names& names, std::uint64_t number, bool may_use) {
    const auto it = names.find(number);
    if (!may_use || it == names.end()) throw std::runtime_error("a name is not known");
    return it->second;
  }

  void read_annotation(std::string_view bytes, bool may_use, PerfettoEvent& event) const {
    std::string name;
    ProtoReader reader(bytes);
    while (const auto field = reader.next()) {
      if (field->number == 1) name = name_in(annotation_names_, field->value, may_use);
      if (field->number == 2 || field->number == 3 || field->number == 4)
        event.numbers[name] = static_cast<double>(static_cast<std::int64_t>(field->value));
      if (field->number == 5) event.numbers[name] = field->real();
      if (field->number == 6) event.texts[name] = field->bytes;
    }
  }

  void read_event(std::string_view bytes, std::int64_t time_ns, bool may_use_names) {
    PerfettoEvent event;
    event.begin_ns = event.end_ns = time_ns;
    ProtoReader reader(bytes);
    while (const auto field = reader.next()) {
      if (field->number == 9) event.type = static_cast<int>(field->value);
      if (field->number == 11) event.track = field->value;
      if (field->number == 10) event.name = name_in(event_names_, field->value, may_use_names);
      if (field->number == 23) event.name = field->bytes;
      if (field->number == 4) read_annotation(field->bytes, may_use_names, event);
      if (field->number == 47) event.flows.push_back(field->value);
      if (field->number == 48) event.flow_ends.push_back(field->value);
      if (field->number == 30) event.value = static_cast<double>(field->value);
      if (field->number == 44) event.value = field->real();
    }
    place(std::move(event));
  }

  /// On its track, where times do not fall and slices nest.
  void place(PerfettoEvent event) {
    const auto track = tracks_.find(event.track);
    if (track == tracks_.end()) throw std::runtime_error("an event without a track");
    if (track->second.is_counter != (event.type == PerfettoEvent::kCounter))
      throw std::runtime_error("a counter's value on another track, or the reverse");
    std::int64_t& last = last_ns_.emplace(event.track, event.begin_ns).first->second;
    if (event.begin_ns < last)
      throw std::runtime_error("times fall on the track " + track->second.name);
    last = event.begin_ns;
    std::vector<std::size_t>& stack = open_[event.track];
    if (event.type == PerfettoEvent::kEnd) {
      if (stack.empty()) throw std::runtime_error("an end without a slice");
      events_[stack.back()].end_ns = event.begin_ns;
      stack.pop_back();
      return;
    }
    event.depth = static_cast<int>(stack.size());
    if (event.type == PerfettoEvent::kBegin) stack.push_back(events_.size());
    events_.push_back(std::move(event));
  }

  std::map<std::uint64_t, PerfettoTrack> tracks_;
  std::vector<PerfettoEvent> events_;  ///< in the order of the file
  Names event_names_;
  Names annotation_names_;
  std::map<std::uint64_t, std::vector<std::size_t>> open_;
  std::map<std::uint64_t, std::int64_t> last_ns_;
  bool is_cleared_ = false;
};

}  // namespace leviosim::tests
