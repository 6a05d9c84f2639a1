// What stands in sections: content as zlib's checksum and zstd's frames have it. The engine of
// pages has another of this (tools/wasm/plain_sections.cpp).
#include <fmt/core.h>
#include <zlib.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <new>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "traces/work_traces/bytes.h"
#include "traces/work_traces/section_file.h"

namespace leviosim::traces {
namespace {

/// @param result  of a function of zstd
void require_memory(std::size_t result) {
  if (ZSTD_getErrorCode(result) == ZSTD_error_memory_allocation) throw std::bad_alloc();
}

[[noreturn]] void fail_section(const std::string& file, const Section& section,
                               const std::string& message) {
  throw InputError(fmt::format("{}, byte {}: {}", file, section.offset, message));
}

}  // namespace

std::uint32_t crc_of(std::string_view a, std::string_view b) {
  uLong crc = 0;
  for (const std::string_view bytes : {a, b})
    if (!bytes.empty())  // zlib takes a null pointer for the wish to begin anew
      crc = crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  return static_cast<std::uint32_t>(crc);
}

std::string packed_section(std::string_view content, int level) {
  check(content.size() <= kLargestSection, "a section is too large");
  std::string stored(ZSTD_compressBound(content.size()), '\0');
  const std::size_t size =
      ZSTD_compress(stored.data(), stored.size(), content.data(), content.size(), level);
  require_memory(size);
  check(!ZSTD_isError(size), "zstd compresses");
  stored.resize(size);
  ByteWriter section;
  section.u32(static_cast<std::uint32_t>(stored.size()));
  section.u32(static_cast<std::uint32_t>(content.size()));
  section.u32(crc_of(section.bytes(), stored));
  section.append(stored);
  return section.take();
}

std::string unpacked(const Section& section, const std::string& file, MemoryBudget& budget) {
  const std::size_t expected = section.content_size;
  // What the frame itself says is its size comes first: a lie about it costs nothing.
  const unsigned long long stated =
      ZSTD_getFrameContentSize(section.stored.data(), section.stored.size());
  if (stated != ZSTD_CONTENTSIZE_UNKNOWN && stated != ZSTD_CONTENTSIZE_ERROR && stated != expected)
    fail_section(file, section,
                 fmt::format("the section holds {} bytes; expected {}", stated, expected));
  if (!budget.take(expected))
    fail_section(file, section, budget.refusal("the content of the section", expected));
  std::string content(expected, '\0');
  const std::size_t size =
      ZSTD_decompress(content.data(), content.size(), section.stored.data(), section.stored.size());
  require_memory(size);
  if (ZSTD_isError(size))
    fail_section(file, section,
                 fmt::format("the section is no zstd frame of {} bytes: {}", expected,
                             ZSTD_getErrorName(size)));
  if (size != expected)
    fail_section(file, section,
                 fmt::format("the section holds {} bytes; expected {}", size, expected));
  return content;
}

}  // namespace leviosim::traces
