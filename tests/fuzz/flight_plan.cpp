// Plans of benchmarks of flights. No flight is opened.
#include "tools/app/study/flights/flight_plan.h"

#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  const std::string text(fuzz::text_of(data, size));
  return fuzz::only_input_errors([&] {
    const tools::FlightPlan plan = tools::parse_flight_plan("fuzzed.yaml", text);
    for (const tools::FlightSet& set : plan.sets) set.text();
    for (const tools::FlightVariant& variant : plan.variants) variant.name();
    if (plan.seeds.empty() || plan.sets.empty() || plan.lengths.empty()) std::abort();
  });
}
