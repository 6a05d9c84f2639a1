// Work traces as files: most damage shows in a checksum.
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/trace_reading.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim::fuzz;
  return only_input_errors([&] { read_and_time(std::string(text_of(data, size)), 2); });
}
