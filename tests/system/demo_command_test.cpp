// The demonstration: both profiles and the what-if on a screen, and what it leaves behind.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/run_program.h"
#include "tools/app/table/terminal_table.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

TEST(DemoCommand, ShowsBothProfilesOnAScreenAndLeavesThemWithAReport) {
  const traces::testing::TempFolder folder;
  const auto path = [&](const char* name) { return (folder.path() / name).string(); };
  traces::write_synthetic_flight(path("flight"), {.duration_s = 1.5, .texel_m = 0.05});
  const std::vector<std::string> words{"demo",    "--data", path("flight"),
                                       "--quiet", "--out",  path("demo")};
  const testing::ProgramResult shown = testing::run_program(folder.path(), words);
  ASSERT_EQ(shown.status, 0) << shown.err;
  int lines = 0;
  std::istringstream in(shown.out);
  for (std::string line; std::getline(in, line); ++lines)
    EXPECT_TRUE(line.find(folder.path().string()) != std::string::npos || display_width(line) <= 80)
        << line;
  EXPECT_LE(lines, 24) << shown.out;
  for (const char* part : {"levio: 1", "next: 1", "feature extraction", "optimiser iteration",
                           "L1 and L2", "one FPU", "240 MHz", "█", "speed-up", "30 frames on GAP9"})
    EXPECT_NE(shown.out.find(part), std::string::npos) << part << " is not in:\n" << shown.out;
  // Pages that compute, or what to do for them.
  const bool computes = shown.out.find("setup.sh pages") == std::string::npos;
  for (const char* file : {"demo/levio.html", "demo/next.html", "demo/next/flight.film"})
    EXPECT_EQ(fs::exists(folder.path() / file), computes) << file;
  if (computes) {
    EXPECT_NE(shown.out.find("played: levio.html and next.html"), std::string::npos);
    const std::string page = base::read_text_file(path("demo/levio.html"));
    ASSERT_EQ(testing::run_program(folder.path(), {"report", path("demo/levio"), "--interactive",
                                                   "-o", path("again.html")})
                  .status,
              0);
    EXPECT_EQ(page.size(), base::read_text_file(path("again.html")).size());
  }
  for (const char* file : {"demo/report.html", "demo/next/run.json"})
    EXPECT_TRUE(fs::exists(folder.path() / file)) << file;
  EXPECT_EQ(shown.out.rfind("verdict: ", 0), 0u) << shown.out;
  // What it suggests works, and nothing of others is replaced.
  for (const char* command : {"whatif", "why"}) {
    EXPECT_NE(shown.out.find(fmt::format("leviosim {} ", command)), std::string::npos) << shown.out;
    EXPECT_EQ(testing::run_program(folder.path(), {command, path("demo/levio")}).status, 0)
        << command;
  }
  EXPECT_EQ(testing::run_program(folder.path(), words).status, 2);
}

}  // namespace
}  // namespace leviosim::tools
