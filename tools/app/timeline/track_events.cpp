#include "tools/app/timeline/track_events.h"

#include "sim/base/check.h"
#include "sim/base/printable.h"
#include "tools/app/timeline/protobuf_writer.h"

namespace leviosim::tools {
namespace {

// Numbers of fields.
namespace trace {
constexpr int kPacket = 1;
}

namespace packet {

constexpr int kTimestamp = 8;

constexpr int kSequence = 10;

constexpr int kTrackEvent = 11;

constexpr int kInternedData = 12;

constexpr int kSequenceFlags = 13;

constexpr int kTrackDescriptor = 60;

}  // namespace packet

namespace descriptor {

constexpr int kNumber = 1;

constexpr int kName = 2;

constexpr int kProcess = 3;

constexpr int kParent = 5;

constexpr int kCounter = 8;

constexpr int kChildOrdering = 11;

constexpr int kRank = 12;

constexpr int kProcessId = 1;

constexpr int kProcessName = 6;

constexpr int kCounterUnit = 3;

constexpr int kCounterUnitName = 6;

}  // namespace descriptor

namespace event {

constexpr int kAnnotation = 4;

constexpr int kType = 9;

constexpr int kNameNumber = 10;

constexpr int kTrack = 11;

constexpr int kName = 23;

constexpr int kCounterValue = 30;

constexpr int kCounterDouble = 44;

constexpr int kFlow = 47;

constexpr int kFlowEnd = 48;

}  // namespace event

namespace annotation {

constexpr int kNameNumber = 1;

constexpr int kBool = 2;

constexpr int kInt = 4;

constexpr int kDouble = 5;

constexpr int kText = 6;

}  // namespace annotation

namespace interned {

constexpr int kEventName = 2;

constexpr int kAnnotationName = 3;

constexpr int kNumber = 1;

constexpr int kName = 2;

}  // namespace interned

constexpr std::uint64_t kSequenceNumber = 1;

constexpr std::uint64_t kStateCleared = 1;

constexpr std::uint64_t kNeedsState = 2;

constexpr std::uint64_t kExplicitOrder = 3;

constexpr std::uint64_t kUnitBytes = 3;

enum Type : int { kSliceBegin = 1, kSliceEnd = 2, kInstant = 3, kCounter = 4 };

std::uint64_t as_unsigned(std::int64_t value) {
  check(value >= 0, "times and counts of a timeline are not negative");
  return static_cast<std::uint64_t>(value);
}

ProtobufWriter described(const Track& track) {
  ProtobufWriter message;
  message.add_uint(descriptor::kNumber, track.number);
  message.add_bytes(descriptor::kName, printable(track.name));
  if (track.parent != 0) {
    message.add_uint(descriptor::kParent, track.parent);
    message.add_uint(descriptor::kRank, as_unsigned(track.rank));
  }
  return message;
}

/// Adds the value under the field of its type.
struct ValueWriter {
  ProtobufWriter& message;
  void operator()(bool value) const { message.add_bool(annotation::kBool, value); }
  void operator()(std::int64_t value) const {
    message.add_uint(annotation::kInt, static_cast<std::uint64_t>(value));
  }
  void operator()(double value) const { message.add_double(annotation::kDouble, value); }
  void operator()(std::string_view value) const {
    message.add_bytes(annotation::kText, printable(value));
  }
};

}  // namespace

void TrackEventWriter::add_root(const Track& track) {
  ProtobufWriter process;
  process.add_uint(descriptor::kProcessId, 1);
  process.add_bytes(descriptor::kProcessName, printable(track.name));
  ProtobufWriter message = described(track);
  message.add_message(descriptor::kProcess, process);
  message.add_uint(descriptor::kChildOrdering, kExplicitOrder);
  add_descriptor(message);
}

void TrackEventWriter::add_track(const Track& track) {
  ProtobufWriter message = described(track);
  message.add_uint(descriptor::kChildOrdering, kExplicitOrder);
  add_descriptor(message);
}

void TrackEventWriter::add_counter_track(const Track& track, CounterUnit unit) {
  ProtobufWriter counter;
  if (unit == CounterUnit::Bytes)
    counter.add_uint(descriptor::kCounterUnit, kUnitBytes);
  else
    counter.add_bytes(descriptor::kCounterUnitName, "mW");
  ProtobufWriter message = described(track);
  message.add_message(descriptor::kCounter, counter);
  add_descriptor(message);
}

void TrackEventWriter::add_descriptor(const ProtobufWriter& descriptor) {
  ProtobufWriter message;
  message.add_uint(packet::kSequence, kSequenceNumber);
  if (is_first_) message.add_uint(packet::kSequenceFlags, kStateCleared);
  is_first_ = false;
  message.add_message(packet::kTrackDescriptor, descriptor);
  ProtobufWriter file;
  file.add_message(trace::kPacket, message);
  bytes_ += file.bytes();
}

void TrackEventWriter::begin(std::uint64_t track, std::int64_t time_ns, const EventText& text) {
  add_event(kSliceBegin, track, time_ns, text);
}

void TrackEventWriter::end(std::uint64_t track, std::int64_t time_ns) {
  ProtobufWriter message;
  message.add_uint(event::kType, kSliceEnd);
  message.add_uint(event::kTrack, track);
  add_packet(time_ns, message, nullptr);
}

void TrackEventWriter::instant(std::uint64_t track, std::int64_t time_ns, const EventText& text) {
  add_event(kInstant, track, time_ns, text);
}

void TrackEventWriter::counter(std::uint64_t track, std::int64_t time_ns, std::int64_t value) {
  ProtobufWriter message;
  message.add_uint(event::kType, kCounter);
  message.add_uint(event::kTrack, track);
  message.add_uint(event::kCounterValue, as_unsigned(value));
  add_packet(time_ns, message, nullptr);
}

void TrackEventWriter::counter(std::uint64_t track, std::int64_t time_ns, double value) {
  ProtobufWriter message;
  message.add_uint(event::kType, kCounter);
  message.add_uint(event::kTrack, track);
  message.add_double(event::kCounterDouble, value);
  add_packet(time_ns, message, nullptr);
}

void TrackEventWriter::rewind(const Mark& mark) {
  bytes_.resize(mark.bytes);
  names_ = mark.names;
  annotation_names_ = mark.annotations;
}

std::uint64_t TrackEventWriter::number_of(std::string_view name, Names& known, int field,
                                          ProtobufWriter& added) {
  if (const auto it = known.find(name); it != known.end()) return it->second;
  const std::uint64_t number = known.size() + 1;
  known.emplace(name, number);
  ProtobufWriter message;
  message.add_uint(interned::kNumber, number);
  message.add_bytes(interned::kName, printable(name));
  added.add_message(field, message);
  return number;
}

void TrackEventWriter::add_event(int type, std::uint64_t track, std::int64_t time_ns,
                                 const EventText& text) {
  ProtobufWriter names;
  ProtobufWriter message;
  message.add_uint(event::kType, static_cast<std::uint64_t>(type));
  message.add_uint(event::kTrack, track);
  if (text.is_unique)
    message.add_bytes(event::kName, printable(text.name));
  else
    message.add_uint(event::kNameNumber, number_of(text.name, names_, interned::kEventName, names));
  for (const Annotation& note : text.annotations) {
    ProtobufWriter value;
    value.add_uint(annotation::kNameNumber,
                   number_of(note.name, annotation_names_, interned::kAnnotationName, names));
    std::visit(ValueWriter{value}, note.value);
    message.add_message(event::kAnnotation, value);
  }
  for (const std::uint64_t flow : text.flows) message.add_fixed64(event::kFlow, flow);
  for (const std::uint64_t flow : text.ends) message.add_fixed64(event::kFlowEnd, flow);
  add_packet(time_ns, message, &names);
}

void TrackEventWriter::add_packet(std::int64_t time_ns, const ProtobufWriter& event,
                                  const ProtobufWriter* names) {
  check(!is_first_, "tracks are described before there are events on them");
  ProtobufWriter message;
  message.add_uint(packet::kTimestamp, as_unsigned(time_ns));
  message.add_uint(packet::kSequence, kSequenceNumber);
  if (names != nullptr) message.add_uint(packet::kSequenceFlags, kNeedsState);
  if (names != nullptr && !names->bytes().empty())
    message.add_message(packet::kInternedData, *names);
  message.add_message(packet::kTrackEvent, event);
  ProtobufWriter file;
  file.add_message(trace::kPacket, message);
  bytes_ += file.bytes();
}

}  // namespace leviosim::tools
