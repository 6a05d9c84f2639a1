// Baselines: read, and a run held against limits that are relative to them.
#include "tools/app/budget/gate.h"

#include "tests/fuzz/checked_run.h"
#include "tests/fuzz/fuzz_target.h"
#include "tools/app/comparison/comparison.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  static const tools::RunRecord run = fuzz::checked_run();
  static const tools::Budget budget =
      tools::parse_budget("budgets.yaml",
                          "budgets:\n"
                          "  - limits:\n"
                          "      - frame latency p99 <= -1 %\n"
                          "      - L1 peak <= -1 kB\n"
                          "      - ATE >= +1 m\n"
                          "      - stage: \"*\"\n"
                          "        limit: cycles <= -1 %\n"
                          "      - stages.*.memory.parallel <= -1 kB\n");
  const std::string text(fuzz::text_of(data, size));
  return fuzz::only_input_errors([&] {
    const tools::RunRecord baseline = tools::parse_baseline("fuzzed.json", text);
    tools::check_comparable(baseline, run, tools::parse_allowed("data,frames,profile,seed,size"));
    fuzz::report(tools::check_budget(run, budget, &baseline));
    tools::baseline_text(baseline, &budget);
  });
}
