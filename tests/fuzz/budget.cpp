// Files of budgets: read, held against a run, and reported.
#include "tools/app/budget/budget.h"

#include "tests/fuzz/checked_run.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  static const tools::RunRecord run = fuzz::checked_run();
  const std::string text(fuzz::text_of(data, size));
  return fuzz::only_input_errors([&] {
    const tools::Budget budget = tools::parse_budget("fuzzed.yaml", text);
    fuzz::report(tools::check_budget(run, budget, &run));
    fuzz::report(tools::check_budget(run, budget, nullptr));
  });
}
