// Entries of the cache of finished runs. After a first byte 'f' the input is a file under a key,
// damage of which shows in a digest; else it is the text in one, as if the digest were right.
#include "tests/fuzz/fuzz_target.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/engine.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  static const std::string key = "ab-fuzzed";
  static fuzz::MemoryFile file("-cache/ab/" + key + ".json");
  static const tools::OutcomeCache cache(file.path().parent_path().parent_path());
  if (size == 0) return 0;
  const std::string_view rest = fuzz::text_of(data + 1, size - 1);
  return fuzz::only_input_errors([&] {
    std::optional<tools::Outcome> outcome;
    if (data[0] == 'f') {
      file.holding(rest);
      outcome = cache.find(key);
    } else {
      outcome = tools::parse_outcome(rest);
    }
    if (!outcome) return;
    const std::string text = tools::to_text(*outcome);
    const std::optional<tools::Outcome> again = tools::parse_outcome(text);
    if (!again || tools::to_text(*again) != text) std::abort();
    tools::run_outcome_of(*outcome);
  });
}
