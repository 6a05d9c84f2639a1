// Platform files, and what is written for one that loads.
#include "platform_models/loader/loader.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  const std::string text(fuzz::text_of(data, size));
  if (text.find('/') != std::string::npos) return 0;  // names of other files
  return fuzz::only_input_errors(
      [&] { platform::to_yaml(platform::resolve_platform_text("fuzzed.yaml", text)); });
}
