// The paper's tables against a run over real frames, with the tolerances and guards of paper.csv.
#include <gtest/gtest.h>

#include <algorithm>

#include "platform_models/loader/loader.h"
#include "tests/traces/test_folder.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/simulate.h"
#include "tools/app/run/workload.h"
#include "tools/app/validation/validation.h"

namespace leviosim::tools {
namespace {

/// All 300 frames: the map is full after 90 of them, and the first 200 have averages that differ by
/// a tenth.
TEST(ValidationPaper, NoFigureIsWorseThanItsToleranceOrItsGuard) {
  const auto folder = traces::testing::recorded_data() / "euroc" / "MH_01_easy_t05_t20";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "no recorded flight: set LEVIOSIM_DATA to the folder that contains euroc/";
  FrameLog log;
  RunRequest request;
  request.data = folder;
  request.platform = platform::resolve_platform("gap9");
  request.observer = &log;
  request.workload = parse_workload_overrides({"workload.released=on"});
  request.time_bands = TimeBandsOf::team_and_one_core;
  const RunResult run = simulate(request, [](const Progress&) {});
  const Validation validation = validate(run, log, profile_of(request), paper_references());
  for (const Comparison& c : validation.comparisons) {
    const Reference& r = c.reference;
    EXPECT_TRUE(c.verdict == Verdict::Met || c.verdict == Verdict::Missed)
        << r.name << " is " << name_of(c.verdict) << ": " << c.value.value_or(-1) << " " << r.unit
        << ", reference " << r.value << ", error " << c.error().value_or(-1) << ", tolerance "
        << r.tolerance.value << ", guard " << r.guard.value_or(r.tolerance.value)
        << (c.verdict == Verdict::Improved ? " (paper.csv may say met)" : "");
  }
  // At least four fifths of the table of cycles lie inside their bands.
  ASSERT_EQ(validation.bands.size(), 12u);
  EXPECT_GE(std::count_if(validation.bands.begin(), validation.bands.end(),
                          [](const BandedStage& band) { return band.is_inside(); }),
            9);
}

}  // namespace
}  // namespace leviosim::tools
