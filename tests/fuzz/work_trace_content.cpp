// Work traces whose checksums are right, whatever they hold: the input is the contents of their
// sections, with kBetweenParts between them. Without sections of kernels it is of version 1.
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/trace_reading.h"
#include "traces/work_traces/section_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  const std::vector<std::string> contents = fuzz::parts_of(fuzz::text_of(data, size));
  const std::uint32_t version = contents.size() % 2 == 0 ? 1 : 2;
  std::string file = traces::file_head({"LEVIOWT\n", "a work trace", version});
  for (const std::string& content : contents) file += traces::packed_section(content, 1);
  return fuzz::only_input_errors([&] { fuzz::read_and_time(std::move(file), 2); });
}
