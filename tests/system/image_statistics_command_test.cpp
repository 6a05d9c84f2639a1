// leviosim image-statistics as users meet it.
#include <gtest/gtest.h>

#include "tests/support/run_program.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

using testing::expect_refused;
using testing::run_program;

TEST(ImageStatisticsCommand, PrintsRecordingsSideBySideOrAsRows) {
  const traces::testing::TempFolder folder;
  const std::string flight = (folder / "flight").string();
  traces::write_synthetic_flight(flight, {.duration_s = 0.4, .texel_m = 0.02});
  const auto pair = run_program(folder.path(), {"image-statistics", flight, flight, "--quiet"});
  ASSERT_EQ(pair.status, 0) << pair.err;
  for (const char* part :
       {"ratio", "1.00", "roundness of corners", "in short: all medians agree within a quarter"})
    EXPECT_NE(pair.out.find(part), std::string::npos) << part << " is not in:\n" << pair.out;
  const auto json =
      run_program(folder.path(), {"image-statistics", flight, "--json", "--frames", "0:4"});
  EXPECT_NE(json.out.find("\"leviosim image statistics\""), std::string::npos) << json.out;
  expect_refused(run_program(folder.path(), {"image-statistics"}), {"DIR"});
  expect_refused(run_program(folder.path(), {"image-statistics", "nowhere"}), {"nowhere"});
  expect_refused(run_program(folder.path(), {"image-statistics", flight, "--frames", "0:99"}),
                 {"0:99", "8"});
}

}  // namespace
}  // namespace leviosim::tools
