#include "traces/work_traces/section_file.h"

#include <fmt/core.h>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "traces/work_traces/bytes.h"

namespace leviosim::traces {
namespace {

constexpr std::size_t kMagicSize = 8;
constexpr std::size_t kCoveredHead = kMagicSize + 4;
constexpr std::size_t kHeadSize = kCoveredHead + 4;
constexpr std::size_t kSizes = 8;
constexpr std::size_t kSectionHead = kSizes + 4;

[[noreturn]] void fail(const std::string& file, std::size_t offset, std::string_view message) {
  throw InputError(fmt::format("{}, byte {}: {}", file, offset, message));
}

void check_head(const FileKind& kind, const std::string& file, std::string_view bytes) {
  if (bytes.substr(0, kMagicSize) != kind.magic)
    throw InputError(fmt::format("{}: is not {}: expected '{}' at its begin", file, kind.name,
                                 kind.magic.substr(0, kMagicSize - 1)));
  if (bytes.size() < kHeadSize)
    fail(file, bytes.size(), "the file ends within its head: it is truncated");
  ByteReader head(bytes.substr(kMagicSize, 8), file);
  const std::uint32_t version = head.u32("version");
  if (head.u32("checksum") != crc_of(bytes.substr(0, kCoveredHead)))
    fail(file, kMagicSize, "the head does not match its checksum: the file is damaged");
  if (version != kind.version)
    throw InputError(fmt::format("{}: is {} of version {}; this leviosim reads version {}: {}",
                                 file, kind.name, version, kind.version,
                                 version > kind.version ? "use a newer one" : "record it again"));
}

}  // namespace

std::string file_head(const FileKind& kind) {
  check_equal(kind.magic.size(), kMagicSize, "bytes that name a kind of file");
  ByteWriter head;
  head.append(kind.magic);
  head.u32(kind.version);
  head.u32(crc_of(head.bytes()));
  return head.take();
}

std::vector<Section> sections_of(const FileKind& kind, const std::string& file,
                                 std::string_view bytes) {
  check_head(kind, file, bytes);
  std::vector<Section> sections;
  for (std::size_t at = kHeadSize; at < bytes.size();) {
    if (bytes.size() - at < kSectionHead)
      fail(file, bytes.size(), "the file ends within the head of a section: it is truncated");
    ByteReader head(bytes.substr(at, kSectionHead), file);
    const std::size_t stored = head.u32("size");
    const std::size_t content = head.u32("size");
    const std::uint32_t crc = head.u32("checksum");
    if (stored > bytes.size() - at - kSectionHead)
      fail(file, bytes.size(),
           fmt::format("the file ends within the section at byte {}, which takes {} bytes: it is "
                       "truncated or damaged",
                       at, stored + kSectionHead));
    const std::string_view payload = bytes.substr(at + kSectionHead, stored);
    if (crc != crc_of(bytes.substr(at, kSizes), payload))
      fail(file, at,
           fmt::format("the section of {} bytes that begins here does not match its checksum: the "
                       "file is damaged",
                       stored + kSectionHead));
    if (content > kLargestSection)
      fail(file, at,
           fmt::format("a section of {} bytes; expected {} at most", content, kLargestSection));
    sections.push_back({at, payload, content});
    at += kSectionHead + stored;
  }
  return sections;
}

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
