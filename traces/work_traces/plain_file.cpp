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

}  // namespace

std::string plain_file(const WorkTrace& trace, std::string_view bytes,
                       std::optional<work::CompiledFor> code) {
  std::string plain = file_head(kWorkTraceFile);
  const std::vector<Section> sections = sections_of(kWorkTraceFile, trace.name(), bytes);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    MemoryBudget budget = trace.budget();
    std::string content = unpacked(sections[i], trace.name(), budget);
    const bool holds_frames = i % 2 == 0 && i < 2 * trace.chunks().size();
    if (code && holds_frames) content = with_code_of(*code, content, trace, budget);
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
