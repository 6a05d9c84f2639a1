// `leviosim platforms feasibility`: the verdicts follow from the recorded work and the chips'
// numbers.
#include "tools/app/study/feasibility/feasibility.h"
#include "tools/app/run/simulate.h"
#include "tools/app/study/feasibility/feasibility_report.h"

#include <gtest/gtest.h>

#include "tests/support/run_program.h"
#include "tests/traces/test_folder.h"
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

/// A core that is busy all the time takes what a busy core takes: no work is left out.
TEST_F(Feasible, AChipThatIsBusyAllTheTimeTakesItsHighestPower) {
  const Feasibility pi = on("arm1176", 1);
  ASSERT_GT(pi.frame_ms(), 50);
  EXPECT_NEAR(pi.power->value.count(), 0.85, 0.002);  // 540 mW, and 310 mW of a busy core
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

/// In tiles through L1, and with the optimiser's records in external memory: the work is another
/// one.
TEST_F(Feasible, SmallMemoriesGetWorkOfTheirOwn) {
  const Feasibility gap8 = on("gap8", 8);
  EXPECT_TRUE(gap8.fits()) << memory_verdict(gap8);
  EXPECT_TRUE(gap8.in_tiles);
  EXPECT_GT(gap8.external, Bytes(300'000));
  EXPECT_NE(memory_verdict(gap8).find("in tiles through L1"), std::string::npos);
  EXPECT_NE(memory_verdict(gap8).find(" kB in external memory"), std::string::npos);
  const Feasibility m7 = on("cortex-m7", 1);
  EXPECT_TRUE(m7.fits()) << memory_verdict(m7);
  EXPECT_FALSE(m7.in_tiles);
  EXPECT_LE(m7.l2.occupied, m7.l2.size);
  // What it costs: time of transfers, energy of external memory.
  const Feasibility roomy = on("cortex-m7", 1, {"l2.size=2MiB"});
  EXPECT_EQ(roomy.external, Bytes(0));
  EXPECT_GE(m7.optimiser_ms, roomy.optimiser_ms);
  EXPECT_GT(m7.energy_per_frame->value, roomy.energy_per_frame->value);
  // Without external memory the shortage is the verdict, of L2 alone.
  const Feasibility m4 = on("cortex-m4f", 1);
  EXPECT_TRUE(m4.l1.fits());
  EXPECT_FALSE(m4.l2.fits());
}

/// The paper: "roughly 300 ms per iteration at 370 MHz" on one core.
TEST_F(Feasible, PublishedTimesStandBesideTheirChips) {
  EXPECT_NE(feasibility_table({on("gap9", 1)}).find("≈ 300"), std::string::npos);
  EXPECT_EQ(feasibility_table({on("gap9-240mhz", 1)}).find("≈ 300"), std::string::npos);
}

TEST_F(Feasible, StagesHaveWhatTheMemoriesAreFilledTo) {
  const Feasibility row = on("gap9", 8);
  EXPECT_NE(stage_comparison({row}).find(fmt::format(
                "{:.1f} of 131.1", static_cast<double>(row.l1.occupied.count()) * 1e-3)),
            std::string::npos)
      << stage_comparison({row});
}

TEST_F(Feasible, StagesRefuseChipsOnWhichARunIsRefused) {
  const traces::testing::TempFolder log;
  const auto stages = [&](std::vector<std::string> further) {
    std::vector<std::string> words{"platforms", "stages",   "--data", folder_.string(),
                                   "--quiet",   "--frames", "0:36"};
    words.insert(words.end(), further.begin(), further.end());
    return testing::run_program(log.path(), words);
  };
  testing::expect_refused(stages({"gap9", "cortex-m4f"}),
                          {"cortex-m4f: ", " kB short of L2 at '", "platforms feasibility"});
  const testing::ProgramResult all = stages({"--jobs", "1"});
  EXPECT_EQ(all.status, 0) << all.err;
  EXPECT_NE(all.out.find("left out: cortex-m4f: "), std::string::npos) << all.out;
  EXPECT_NE(all.out.find("L2 peak kB"), std::string::npos) << all.out;
}

TEST_F(Feasible, SystemsStandBesideWhatIsPredicted) {
  const traces::testing::TempFolder log;
  const auto systems = [&](std::vector<std::string> further) {
    std::vector<std::string> words{"platforms", "systems",  "--data", folder_.string(),
                                   "--quiet",   "--frames", "0:36"};
    words.insert(words.end(), further.begin(), further.end());
    return testing::run_program(log.path(), words);
  };
  const testing::ProgramResult result =
      systems({"--report", (log / "s.html").string(), "--csv", (log / "s.csv").string()});
  EXPECT_EQ(result.status, 0) << result.err;
  for (const char* part :
       {"Navion", "flow on gap8", "flow on cortex-m4f", "levio on gap9",
        "levio-no-imu on cortex-m7", "next on cortex-m7", "next on arm1176", "an FPGA"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << " is not in:\n" << result.out;
  EXPECT_NE(base::read_text_file(log / "s.html").find("predicted here"), std::string::npos);
  // The prediction for LEVIO is that of the feasibility.
  const Feasibility row = on("gap9", 8);
  EXPECT_GT(row.frames_per_second(), 20);
  const std::string csv = base::read_text_file(log / "s.csv");
  constexpr std::string_view kLevio = ",levio on gap9,";
  const std::size_t levio = csv.find(kLevio);
  ASSERT_NE(levio, std::string::npos);
  EXPECT_NEAR(std::stod(csv.substr(levio + kLevio.size())), 20, 1e-6);
  testing::expect_refused(systems({"gap9"}), {"expected no platform, found 1"});
  testing::expect_refused(systems({"--profile", "next"}), {"leave out --profile"});
  testing::expect_refused(systems({"--csv", "x", "--report", "x"}), {"--report"});
}

/// A chip that cannot be is a row with its reason, and costs the others nothing.
TEST_F(Feasible, AChipThatCannotBeIsARowWithItsReason) {
  const traces::testing::TempFolder log;
  const auto table = [&](std::vector<std::string> further) {
    std::vector<std::string> words{"platforms", "feasibility", "--data", folder_.string(),
                                   "--quiet",   "--frames",    "0:12",   "--json"};
    words.insert(words.end(), further.begin(), further.end());
    return testing::run_program(log.path(), words);
  };
  const testing::ProgramResult result = table(
      {"-p", "cluster.workers=16", "-p", "cluster.max_workers=16", "-p", "cluster.l1.size=256KiB"});
  EXPECT_EQ(result.status, 0) << result.err;
  bool runs = false;
  const Json all = Json::parse(result.out);
  for (const Json& row : all.at("rows"))
    if (row.at("platform") == "gap9" && row.at("cores") == 16)
      runs = row.at("failure").is_null() && row.at("front_end_ms").get<double>() > 0;
  EXPECT_TRUE(runs) << result.out;
  const testing::ProgramResult some = table({"-p", "cluster.workers=8"});
  EXPECT_EQ(some.status, 0) << some.err;
  bool refused = false;
  const Json fewer = Json::parse(some.out);
  for (const Json& row : fewer.at("rows"))
    if (row.at("platform") == "arm1176")
      refused =
          row.at("failure").get<std::string>().find("cluster.max_workers") != std::string::npos;
  EXPECT_TRUE(refused) << some.out;
  testing::expect_refused(table({"arm1176", "-p", "cluster.workers=8"}), {"cluster.max_workers"});
}

/// The workload of all chips can be set, as that of a run.
TEST_F(Feasible, StagesTakeParametersOfTheWorkload) {
  const traces::testing::TempFolder log;
  testing::expect_refused(
      testing::run_program(log.path(), {"platforms", "stages", "-p", "workload.windw=6"}),
      {"workload.windw", "did you mean 'workload.window'"});
}

TEST_F(Feasible, ARunOfALargeImageNamesTheCellsThatFillTheMemory) {
  const traces::testing::TempFolder log;
  testing::expect_refused(
      testing::run_program(log.path(), {"run", "--platform", "gap9", "--data", folder_.string(),
                                        "--size", "752x480", "--quiet", "--out", "big"}),
      {"does not fit in", "cell of 8 px", "-p workload.cell=N"});
}

TEST_F(Feasible, AChipOfMoreCoresThanTheOthersHasItsOwnWork) {
  const Feasibility twelve = on("gap9", 12, {"cluster.workers=12", "cluster.max_workers=12"});
  EXPECT_LT(twelve.front_end_ms, on("gap9", 8).front_end_ms);
  const Feasibility sixteen =
      on("gap9", 16, {"cluster.workers=16", "cluster.max_workers=16", "cluster.l1.size=256KiB"});
  EXPECT_LT(sixteen.front_end_ms, twelve.front_end_ms);
  EXPECT_TRUE(sixteen.fits());
  traces::testing::expect_input_error([] { on("gap9", 12); }, {"12", "8"});
}

}  // namespace
}  // namespace leviosim::tools
