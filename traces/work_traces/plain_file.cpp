#include "traces/work_traces/plain_file.h"

#include "traces/work_traces/bytes.h"

namespace leviosim::traces {

std::string plain_file(const FileKind& kind, const std::string& file, std::string_view bytes,
                       MemoryBudget budget) {
  std::string plain = file_head(kind);
  for (const Section& section : sections_of(kind, file, bytes)) {
    const std::string content = unpacked(section, file, budget);
    ByteWriter head;
    head.u32(static_cast<std::uint32_t>(content.size()));
    head.u32(static_cast<std::uint32_t>(content.size()));
    head.u32(crc_of(head.bytes(), content));
    plain += head.bytes();
    plain += content;
  }
  return plain;
}

}  // namespace leviosim::traces
