// Work traces whose checksums are right, whatever they hold: the input is the contents of their
// sections, with kBetweenParts between them.
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/trace_reading.h"
#include "traces/work_traces/section_file.h"
#include "traces/work_traces/work_trace.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  const std::vector<std::string> contents = fuzz::parts_of(fuzz::text_of(data, size));
  std::string file = traces::file_head(traces::kWorkTraceFile);
  for (const std::string& content : contents) file += traces::packed_section(content, 1);
  return fuzz::only_input_errors([&] { fuzz::read_and_time(std::move(file), 2); });
}
