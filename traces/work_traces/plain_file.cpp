#include "traces/work_traces/plain_file.h"

#include "traces/work_traces/bytes.h"
#include "traces/work_traces/work_columns.h"

namespace leviosim::traces {
namespace {

/// A section of frames with less in its series.
std::string with_code_of(work::CompiledFor code, const std::string& content, const WorkTrace& trace,
                         MemoryBudget& budget) {
  ByteReader in(content, trace.name(), &budget);
  ByteWriter out;
  out.whole(in.whole("the number of frames"));
  ByteReader heads(in.text("series"), trace.name(), &budget);
  ByteReader columns(in.text("columns"), trace.name(), &budget);
  ByteWriter kept_heads;
  ByteWriter kept_columns;
  const std::size_t number = heads.count("series", sizeof(SeriesReader));
  kept_heads.whole(number);
  for (std::size_t i = 0; i < number; ++i)
    SeriesReader(heads, columns, trace.fields(), code)
        .write(trace.fields(), kept_heads, kept_columns);
  out.text(kept_heads.bytes());
  out.text(kept_columns.bytes());
  out.append(in.take(in.left(), "frames"));
  return out.take();
}

std::string plain_section(const std::string& content) {
  ByteWriter head;
  head.u32(static_cast<std::uint32_t>(content.size()));
  head.u32(static_cast<std::uint32_t>(content.size()));
  head.u32(crc_of(head.bytes(), content));
  return head.take() + content;
}

}  // namespace

std::string plain_file(const WorkTrace& trace, std::optional<work::CompiledFor> code) {
  std::string plain = file_head(kWorkTraceFile);
  for (const WorkTrace::Chunk& chunk : trace.chunks()) {
    MemoryBudget budget = trace.budget();
    const std::string frames = unpacked(chunk.section, trace.name(), budget);
    plain += plain_section(code ? with_code_of(*code, frames, trace, budget) : frames);
    plain += plain_section(unpacked(chunk.offload, trace.name(), budget));
  }
  MemoryBudget budget = trace.budget();
  return plain + plain_section(unpacked(trace.summary(), trace.name(), budget));
}

}  // namespace leviosim::traces
