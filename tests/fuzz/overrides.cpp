// Overrides of platform parameters (-p), one a line.
#include "platform_models/loader/platform_file.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  static platform::PlatformFile chip = platform::PlatformFile::named("gap9");
  std::vector<std::string> overrides;
  for (std::string_view rest = fuzz::text_of(data, size); !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    overrides.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return fuzz::only_input_errors([&] { platform::to_yaml(chip.resolve(overrides)); });
}
