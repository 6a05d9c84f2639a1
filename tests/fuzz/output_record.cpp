// Records of what leviosim wrote (.leviosim-files): what is read is written and read again as the
// same, and names nothing outside its folder.
#include "sim/outputs/output_record.h"

#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  return fuzz::only_input_errors([&] {
    const auto record = outputs::OutputRecord::parse(fuzz::text_of(data, size), "fuzzed");
    const std::string text = record.text();
    if (outputs::OutputRecord::parse(text, "again").text() != text) std::abort();
    for (const std::string& path : record.paths()) {
      const std::filesystem::path place = std::filesystem::path("/folder") / path;
      const bool is_below = place.lexically_normal() == place && place.string().size() > 8 &&
                            place.string().starts_with("/folder/");
      if (!is_below || path == outputs::kRecordName) std::abort();
    }
  });
}
