// `leviosim platforms feasibility`: the verdicts follow from the recorded work and the chips'
// numbers.
#include "tools/app/study/feasibility/feasibility.h"
#include "tools/app/run/simulate.h"

#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"
#include "tools/app/study/feasibility/feasibility_report.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

using platform::resolve_platform;

/// Two seconds of synthetic flight and the work over it, made once.
class Feasible : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ =
        std::filesystem::temp_directory_path() / fmt::format("leviosim-{}-feasibility", ::getpid());
    traces::write_synthetic_flight(folder_, {.duration_s = 2, .texel_m = 0.01});
    RunRequest request;
    request.data = folder_;
    study_ = std::make_unique<FeasibilityStudy>(request, [](const Progress&) {});
  }
  static void TearDownTestSuite() {
    study_.reset();
    std::filesystem::remove_all(folder_);
  }
  static Feasibility on(const std::string& name, int cores,
                        const std::vector<std::string>& overrides = {}) {
    const platform::ResolvedPlatform chip = resolve_platform(name, overrides);
    return study_->on(FeasibilityPoint{name, chip, cores});
  }

  inline static std::filesystem::path folder_;
  inline static std::unique_ptr<FeasibilityStudy> study_;
};

TEST_F(Feasible, TimesOfAChipAreThoseOfARunOnIt) {
  RunRequest request;
  request.data = folder_;
  request.platform = resolve_platform("gap9");
  const RunResult run = simulate(request, [](const Progress&) {});
  double sum_ms = 0;
  for (const FrameResult& frame : run.frames)
    sum_ms += static_cast<double>(frame.cycles.count()) / 370e3;
  const Feasibility row = on("gap9", 8);
  EXPECT_NEAR(row.front_end_ms, sum_ms / static_cast<double>(run.frames.size()), 1e-6);
  EXPECT_TRUE(row.fits());
  EXPECT_TRUE(row.l1.block.empty() && row.l2.block.empty());
}

TEST_F(Feasible, TheClockScalesTimeAndTheVoltageEnergy) {
  const Feasibility fast = on("gap9-370mhz", 8);
  const Feasibility slow = on("gap9-240mhz", 8);
  EXPECT_NEAR(slow.front_end_ms / fast.front_end_ms, 370.0 / 240.0, 1e-3);
  EXPECT_LT(slow.power->value, fast.power->value);
}

TEST_F(Feasible, OneCoreTakesLongerAndAChipWithOneCoreDoesOneAfterTheOther) {
  EXPECT_GT(on("gap9", 1).front_end_ms, 4 * on("gap9", 8).front_end_ms);
  const Feasibility gap9 = on("gap9", 1);
  EXPECT_DOUBLE_EQ(gap9.frame_ms(), std::max(gap9.front_end_ms, gap9.optimiser_ms));
  const Feasibility m7 = on("cortex-m7-h7a3", 1);
  EXPECT_DOUBLE_EQ(m7.frame_ms(), m7.front_end_ms + m7.optimiser_ms);
  EXPECT_NEAR(m7.power->value.count(), 0.154, 0.002);  // whatever it does
}

TEST_F(Feasible, NamesTheBlockThatDoesNotFitAndGivesTheTimeAllTheSame) {
  const Feasibility small = on("gap9", 8, {"cluster.l1.size=16KiB", "l2.size=16KiB"});
  EXPECT_FALSE(small.l1.fits());
  EXPECT_FALSE(small.l2.fits());
  EXPECT_FALSE(small.l1.block.empty());
  EXPECT_FALSE(small.l2.block.empty());
  EXPECT_EQ(small.front_end_ms, on("gap9", 8).front_end_ms);
  const std::string table = feasibility_table({small});
  EXPECT_NE(table.find("'" + small.l1.block + "'"), std::string::npos) << table;
  EXPECT_NE(table.find("if it had the memory"), std::string::npos);
  EXPECT_EQ(feasibility_table({on("gap9", 8)}).find("if it had the memory"), std::string::npos);
}

/// The paper: "roughly 300 ms per iteration at 370 MHz" on one core.
TEST_F(Feasible, PublishedTimesStandBesideTheirChips) {
  EXPECT_NE(feasibility_table({on("gap9", 1)}).find("≈ 300"), std::string::npos);
  EXPECT_EQ(feasibility_table({on("gap9-240mhz", 1)}).find("≈ 300"), std::string::npos);
}

TEST_F(Feasible, AChipOfMoreCoresThanTheOthersHasItsOwnWork) {
  const Feasibility sixteen = on("gap9", 16, {"cluster.workers=16", "cluster.max_workers=16"});
  EXPECT_LT(sixteen.front_end_ms, on("gap9", 8).front_end_ms);
  traces::testing::expect_input_error([] { on("gap9", 16); }, {"16", "8"});
}

}  // namespace
}  // namespace leviosim::tools
