// JSON from outside: nothing beyond the limits is built, and what is read is written and read again
// as the same.
#include "tools/app/table/json.h"
#include "tests/fuzz/fuzz_target.h"
#include "tools/app/record/json_reader.h"

namespace {

using namespace leviosim;  // NOLINT: a program of one file

constexpr tools::JsonLimits kLimits{.bytes = 60'000, .depth = 64, .values = 10'000};

std::size_t depth_of(const tools::Json& json) {
  std::size_t deepest = 0;
  for (const auto& entry : json.items()) {
    if (!entry.value().is_structured()) continue;
    deepest = std::max(deepest, depth_of(entry.value()));
  }
  return deepest + 1;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::only_input_errors([&] {
    const tools::Json json = tools::read_json("fuzzed.json", fuzz::text_of(data, size), kLimits);
    if (depth_of(json) > kLimits.depth) std::abort();
    const std::string text = json.dump();
    if (tools::read_json("again.json", text).dump() != text) std::abort();
  });
}
