// Plans of sweeps. What they name is opened, too: only built-in
// platforms are there.
#include "tests/fuzz/fuzz_target.h"
#include "tools/app/study/sweep/plan.h"
#include "tools/app/study/sweep/sweep_inputs.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  const std::string text(fuzz::text_of(data, size));
  if (text.find('/') != std::string::npos || text.find("synthetic") != std::string::npos) return 0;
  return fuzz::only_input_errors([&] {
    tools::SweepInputs inputs("/dev/shm/no-such-folder", tools::ProgressLine::Style::None,
                              Bytes(8 << 20));
    tools::parse_plan("fuzzed.yaml", text, inputs);
  });
}
