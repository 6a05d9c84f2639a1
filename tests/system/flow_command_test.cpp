// leviosim flow as users meet it, and what stands behind its figures.
#include <gtest/gtest.h>

#include "platform_models/loader/loader.h"
#include "tests/support/paths.h"
#include "tests/support/run_program.h"
#include "tools/app/flow/binned_frames.h"
#include "tools/app/flow/flow.h"
#include "tools/app/flow/flow_report.h"
#include "tools/app/result/energy_summary.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

using testing::expect_refused;
using testing::ProgramResult;
using testing::run_program;
using traces::testing::AslFolder;
using traces::testing::TempFolder;

class FlowCommand : public ::testing::Test {
 protected:
  ProgramResult flow(std::vector<std::string> words) {
    words.insert(words.begin(), "flow");
    words.push_back("--quiet");
    return run_program(folder_.path(), words);
  }
  ProgramResult flow_of_flight(const std::string& platform, const std::string& out,
                               const std::vector<std::string>& further = {}) {
    if (!std::filesystem::exists(folder_ / "flight"))
      traces::write_synthetic_flight(folder_ / "flight", {.duration_s = 0.4, .texel_m = 0.02});
    std::vector<std::string> words = {"--platform",   platform, "--data",
                                      path("flight"), "--out",  path(out)};
    words.insert(words.end(), further.begin(), further.end());
    return flow(words);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  TempFolder folder_;
};

TEST_F(FlowCommand, PrintsTheTablesOfAllWorkloadsAndItsOwn) {
  const ProgramResult result = flow_of_flight("gap8", "out", {"--fps", "500"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* part :
       {"px4flow on gap8, 8 frames", "64x64", "image transfer", "block matching", "flow vote",
        "not measured as compiled code", "% of block matching",
        "where the core-cycles go on 8 cores", "frames that the chip could do at 175 MHz",
        "blocks alive at the peak", "image before", "mean power at 500.0 frames/s",
        "published figures", "power at 500 frames/s", "7.21", "blocks have texture"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << " is not in:\n" << result.out;
}

TEST_F(FlowCommand, ChipsWithoutPublishedFiguresOrEnergyDoWithout) {
  const ProgramResult result = flow_of_flight("gap9", "out", {"--cores", "4"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out.find("published figures"), std::string::npos);
  const std::string quad = (leviosim::tests::source_folder() / "tests/examples/quad.yaml").string();
  ASSERT_EQ(flow_of_flight(quad, "quad").status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "quad/energy.csv"));
}

/// The flow does not depend on the chip, and the same inputs give the same bytes.
TEST_F(FlowCommand, LeavesTheSameBytesAgainAndTheSameFlowOnAnyChip) {
  ASSERT_EQ(flow_of_flight("gap8", "a").status, 0);
  ASSERT_EQ(flow_of_flight("gap8", "b").status, 0);
  ASSERT_EQ(flow_of_flight("cortex-m4f", "c").status, 0);
  auto a = traces::testing::contents(folder_ / "a");
  auto b = traces::testing::contents(folder_ / "b");
  auto c = traces::testing::contents(folder_ / "c");
  EXPECT_EQ(a.size(), 7u);
  a.erase("manifest.json");
  b.erase("manifest.json");
  EXPECT_EQ(a, b);
  const auto without_cycles = [](const std::string& csv) {
    std::string text;
    for (std::size_t at = 0; at < csv.size(); at = csv.find('\n', at) + 1) {
      std::size_t end = at;
      for (int commas = 0; commas < 7; ++end) commas += csv[end] == ',';
      text += csv.substr(at, end - at) + '\n';
    }
    return text;
  };
  EXPECT_NE(a["flow.csv"], c["flow.csv"]);
  EXPECT_EQ(without_cycles(a["flow.csv"]), without_cycles(c["flow.csv"]));
}

TEST_F(FlowCommand, RefusesWhatItCannotDo) {
  const AslFolder small;
  const std::string data = small.root().string();
  const auto refused = [&](std::vector<std::string> words, const std::vector<std::string>& parts) {
    words.insert(words.end(), {"--out", path("out")});
    expect_refused(flow(words), parts);
  };
  refused({"--data", data}, {"--platform is missing"});
  refused({"--platform", "gap8"}, {"--data is missing"});
  refused({"--platform", "gap7", "--data", data}, {"gap7", "gap8"});
  refused({"--platform", "gap8", "--data", data}, {"32x24 px", "64x64"});
  refused({"--platform", "gap8", "--data", data, "--grid", "0"}, {"--grid '0'"});
  refused({"--platform", "gap8", "--data", data, "--grid", "50"}, {"grid is 50", "1 to 47"});
  refused({"--platform", "gap8", "--data", data, "--search", "17"}, {"--search '17'", "16"});
  refused({"--platform", "gap8", "--data", data, "--fps", "no"}, {"--fps 'no'"});
  refused({"--platform", "gap8", "--data", data, "--fps", "1e-10"}, {"from 0.001 to 100000"});
  refused({"--platform", "gap8", "--data", data, "--cores", "9"}, {"--cores '9'"});
  refused({"--platform", "gap8", "--data", data, "--girth", "9"}, {"--girth", "--grid"});
  refused({"--platform", "gap8", "--data", path("nowhere")}, {"nowhere"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(FlowCommand, SaysWhichImageDoesNotFitInL1) {
  const ProgramResult result = flow_of_flight("gap8", "out", {"-p", "cluster.l1.size=6KiB"});
  expect_refused(result, {"image before", "L1", "bytes are missing"});
}

// 4×4 pixels of the sensor are one; the window lies in the middle of the remaining columns and
// rows.
TEST(BinnedWindow, HoldsTheMeansOfTheMiddle) {
  traces::GrayImage image{.width = 12, .height = 8, .pixels = {}, .t_ns = 0};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.pixels.push_back(static_cast<std::uint8_t>(x < 2 || x > 9 ? 255 : 10 * x + y));
  // Columns 2 … 9 and all rows: the mean of 10 (2, 3, 4, 5) is 35, and of the rows 0 … 3 is 1.5.
  EXPECT_EQ(binned_window(image, 4, 2), (std::vector<std::uint8_t>{37, 77, 41, 81}));
  EXPECT_EQ(binned_window(image, 1, 2), (std::vector<std::uint8_t>{53, 63, 54, 64}));
}

RunResult example() {
  RunResult run;
  run.chip = platform::load_platform("gap9");
  run.cores = 8;
  run.cluster_clock = run.controller_clock = run.chip.cluster.clock;
  run.frame_period_ns = 50'000'000;
  for (int i = 0; i < 3; ++i) {
    FrameResult frame;
    frame.index = i;
    frame.arrival_ns = i * run.frame_period_ns;
    frame.cycles = Cycles(i == 0 ? 1'000 : 100'000);
    frame.single_cycles = Cycles(i == 0 ? 1'000 : 600'000);
    run.frames.push_back(frame);
  }
  return run;
}

TEST(PublishedFlow, IsComparedWithTheSameCyclesAtItsClock) {
  const RunResult run = example();
  PublishedFlow row;
  row.cores = 8;
  row.clock_mhz = 50;
  row.figure = FlowFigure::FrameRate;
  EXPECT_DOUBLE_EQ(*predicted(row, run), 500);
  row.figure = FlowFigure::SpeedUp;
  EXPECT_DOUBLE_EQ(*predicted(row, run), 6);
  row.cores = 4;
  EXPECT_FALSE(predicted(row, run));
}

TEST(PublishedFlow, PowerIsThatOfTheRateAtTheLowestVoltage) {
  const RunResult run = example();
  PublishedFlow row;
  row.cores = 8;
  row.figure = FlowFigure::Power;
  row.clock_mhz = 370;
  row.rate = 20;
  EXPECT_DOUBLE_EQ(*predicted(row, run), energy_of(run)->mean_power()->value.count() * 1e3);
  // Idle but for the clock and static power; both fall with the clock and the voltage.
  const double fast = *predicted(row, run);
  row.clock_mhz = 50;
  EXPECT_LT(*predicted(row, run), 0.5 * fast);
  row.clock_mhz = 500;
  EXPECT_FALSE(predicted(row, run));
}

TEST(PublishedFlow, EveryRowNamesAPlatformThatThereIs) {
  const std::vector<PublishedFlow> rows = published_flow();
  EXPECT_EQ(rows.size(), 4u);
  for (const PublishedFlow& row : rows) {
    bool known = false;
    for (const std::string& name : platform::platform_names())
      known |= platform::resolve_platform(name).name == row.platform;
    EXPECT_TRUE(known) << row.platform;
    EXPECT_GT(row.value, 0);
    EXPECT_FALSE(row.source.empty());
  }
}

}  // namespace
}  // namespace leviosim::tools
