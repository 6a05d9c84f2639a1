// Sections of a work trace in the engine of pages: they are not compressed, since the page is.
// Left out: writing them (tools/app/interactive/plain_trace.h).
#include <fmt/core.h>

#include <array>

#include "sim/base/error.h"
#include "traces/work_traces/section_file.h"

namespace leviosim::traces {
namespace {

/// CRC-32 as in zlib, by tables of one byte.
constexpr std::array<std::uint32_t, 256> kCrc = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    table[i] = i;
    for (int bit = 0; bit < 8; ++bit)
      table[i] = table[i] >> 1 ^ ((table[i] & 1) != 0 ? 0xedb88320U : 0);
  }
  return table;
}();

}  // namespace

std::uint32_t crc_of(std::string_view a, std::string_view b) {
  std::uint32_t crc = ~std::uint32_t{0};
  for (const std::string_view bytes : {a, b})
    for (const char byte : bytes)
      crc = crc >> 8 ^ kCrc[(crc ^ static_cast<std::uint8_t>(byte)) & 0xff];
  return ~crc;
}

std::string unpacked(const Section& section, const std::string& file, MemoryBudget& budget) {
  if (section.stored.size() != section.content_size)
    throw InputError(fmt::format("{}, byte {}: the section is compressed; expected it plain", file,
                                 section.offset));
  if (!budget.take(section.content_size))
    throw InputError(budget.refusal("the content of the section", section.content_size));
  return std::string(section.stored);
}

}  // namespace leviosim::traces
