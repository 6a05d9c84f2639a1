// Files of a sweep's points. What is read is written again as the same table, and no other file of
// the folder disappears.
#include "tests/fuzz/fuzz_target.h"
#include "tools/app/study/sweep/pareto_front.h"
#include "tools/app/study/sweep/sweep_store.h"

namespace {

namespace fs = std::filesystem;
using namespace leviosim;  // NOLINT: a program of one file

/// Everything that commands ask a sweep that is not theirs.
void read(const fs::path& folder) {
  const tools::SweepStore store(folder);
  store.place();
  for (const tools::SweepOutcome& outcome : store.outcomes()) {
    if (!store.result_of(outcome.point)) std::abort();
    store.settings_of(outcome.point);
  }
  tools::pareto_front(store.outcomes());
  if (store.csv() != tools::SweepStore(folder).csv()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file(std::string("-sweep/") + tools::kSweepFile);
  static const fs::path folder = file.path().parent_path();
  file.holding(fuzz::text_of(data, size));
  return fuzz::only_input_errors([&] { read(folder); });
}
