// run --record, replay and trace as users meet them.
#include <gtest/gtest.h>

#include "tests/support/run_program.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::ProgramResult;
using testing::run_program;
using traces::testing::TempFolder;

class ReplayCommand : public ::testing::Test {
 protected:
  ProgramResult program(const std::vector<std::string>& words) {
    return run_program(folder_.path(), words);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void record() {
    traces::write_synthetic_flight(folder_ / "flight", {.duration_s = 1, .texel_m = 0.02});
    const ProgramResult result = program({"run", "--platform", "gap9", "--data", path("flight"),
                                          "--out", path("run"), "--record", "--quiet"});
    ASSERT_EQ(result.status, 0) << result.err;
  }

  TempFolder folder_;
};

TEST_F(ReplayCommand, LeavesTheFolderOfTheRun) {
  record();
  const ProgramResult result =
      program({"replay", path("run"), "--platform", "gap9", "--out", path("again"), "--quiet"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("computes the same"), std::string::npos) << result.out;
  auto before = traces::testing::contents(folder_ / "run");
  auto after = traces::testing::contents(folder_ / "again");
  EXPECT_EQ(before.erase("work.trace"), 1u);
  EXPECT_EQ(before.erase("errors.csv"), 1u) << "a work trace holds no truth";
  EXPECT_EQ(after.erase("replay.csv"), 1u);
  EXPECT_NE(before["manifest.json"], after["manifest.json"]);
  EXPECT_NE(after["manifest.json"].find("trace_sha256"), std::string::npos);
  before.erase("manifest.json");
  after.erase("manifest.json");
  EXPECT_EQ(before, after);
}

// What passes in tiles, and how much of it a larger L1 would not move, is a fact of the work.
TEST_F(ReplayCommand, SaysOfTilesWhatTheRunSaid) {
  traces::write_synthetic_flight(folder_ / "flight", {.duration_s = 1, .texel_m = 0.02});
  const ProgramResult run = program({"run", "--data", path("flight"), "-p", "cluster.l1.size=32KiB",
                                     "--out", path("run"), "--record", "--quiet"});
  const ProgramResult again = program({"replay", path("run"), "--out", path("again"), "--quiet"});
  ASSERT_EQ(run.status + again.status, 0) << run.err << again.err;
  const auto tiles_of = [](const ProgramResult& result) {
    const std::size_t begin = result.out.find("in tiles: ");
    return begin == std::string::npos ? "none" : result.out.substr(begin, 300);
  };
  EXPECT_NE(tiles_of(run).find(" more)"), std::string::npos) << run.out;
  EXPECT_EQ(tiles_of(again).substr(0, 200), tiles_of(run).substr(0, 200));
}

TEST_F(ReplayCommand, AFilmIsOneFileMoreAndChangesNoOther) {
  record();
  const ProgramResult result = program(
      {"run", "--data", path("flight"), "--out", path("filmed"), "--record", "--film", "--quiet"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("film: "), std::string::npos) << result.out;
  auto with = traces::testing::contents(folder_ / "filmed");
  auto without = traces::testing::contents(folder_ / "run");
  EXPECT_GT(with["flight.film"].size(), 20u * 1000);
  EXPECT_LT(with["flight.film"].size(), 20u * 5000) << "300 frames within 1.5 MB";
  EXPECT_EQ(with.erase("flight.film"), 1u);
  for (const char* names_command : {"manifest.json", ".leviosim-files"}) {
    with.erase(names_command);
    without.erase(names_command);
  }
  EXPECT_EQ(with, without);
}

TEST_F(ReplayCommand, RefusesAFilmWithoutWork) {
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"run", "--film", "--out", path("o"), "--data", "x"});
    return program(words);
  };
  expect_refused(run({}), {"--film", "--record"});
  expect_refused(run({"--native"}), {"--film", "--native"});
}

TEST_F(ReplayCommand, TakesThePlatformOfTheRecordingByDefault) {
  record();
  ASSERT_EQ(program({"replay", path("run/work.trace"), "--out", path("again"), "--quiet"}).status,
            0);
  EXPECT_EQ(base::read_text_file(folder_ / "run/run.json"),
            base::read_text_file(folder_ / "again/run.json"));
  ASSERT_EQ(program({"replay", path("run"), "-p", "isa.ops.load_stream.issue=1.5", "--out",
                     path("slower"), "--quiet"})
                .status,
            0);
  EXPECT_NE(base::read_text_file(folder_ / "run/stages.csv"),
            base::read_text_file(folder_ / "slower/stages.csv"));
}

TEST_F(ReplayCommand, AnotherInstructionSetIsThatOfTheRecordingsChip) {
  record();
  const auto stages_of = [&](std::vector<std::string> words) {
    const std::string out = path("out");
    words.insert(words.begin(), {"replay", path("run"), "--out", out, "--force", "--quiet"});
    const ProgramResult result = program(words);
    EXPECT_EQ(result.status, 0) << result.err;
    return base::read_text_file(folder_ / "out/stages.csv");
  };
  const std::string plain = stages_of({"-p", "isa.base=rv32imfc"});
  EXPECT_EQ(plain, stages_of({"--platform", "gap9", "-p", "isa.base=rv32imfc"}));
  EXPECT_NE(plain, stages_of({}));
}

TEST_F(ReplayCommand, TraceShowsAndChecks) {
  record();
  const ProgramResult info = program({"trace", "info", path("run/work.trace")});
  EXPECT_EQ(info.status, 0) << info.err;
  for (const char* part : {"20 frames", "8 cores", "gap9", "feature extraction", "kB per frame"})
    EXPECT_NE(info.out.find(part), std::string::npos) << part << " is not in:\n" << info.out;
  const ProgramResult check = program({"trace", "check", path("run/work.trace")});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_NE(check.out.find("20 frames"), std::string::npos) << check.out;

  std::string bytes = base::read_text_file(folder_ / "run/work.trace");
  bytes.resize(bytes.size() / 2);
  outputs::write_file_atomically(folder_ / "cut.trace", bytes);
  for (const char* action : {"info", "check"})
    expect_refused(program({"trace", action, path("cut.trace")}), {"cut.trace", "truncated"});
  expect_refused(program({"replay", path("cut.trace"), "--out", path("none")}),
                 {"cut.trace", "truncated"});
  EXPECT_FALSE(fs::exists(folder_ / "none"));
}

TEST_F(ReplayCommand, RefusesWhatIsMissing) {
  expect_refused(program({"trace"}), {"ACTION is missing", "info or check"});
  expect_refused(program({"trace", "chek", "x"}), {"'chek'", "did you mean 'check'"});
  expect_refused(program({"trace", "info", path("nowhere")}), {"nowhere"});
  expect_refused(program({"replay"}), {"TRACE is missing"});
  expect_refused(program({"replay", "x"}), {"--out is missing"});
  expect_refused(program({"replay", folder_.path().string(), "--out", path("o")}),
                 {"holds no work.trace", "--record"});
  expect_refused(program({"run", "--native", "--record", "--data", "x", "--out", path("o")}),
                 {"--native", "--record"});
}

TEST_F(ReplayCommand, RefusesWhatTheRecordingCannotShow) {
  record();
  expect_refused(program({"replay", path("run"), "--cores", "4", "--out", path("o"), "--quiet"}),
                 {"8 cores", "--cores 8", "record again"});
  expect_refused(program({"replay", path("run"), "--cores", "40", "--out", path("o")}),
                 {"--cores '40'"});
  expect_refused(program({"replay", path("run"), "-p", "workload.window=4", "--out", path("o")}),
                 {"workload.window=4", "recorded work"});
  EXPECT_FALSE(fs::exists(folder_ / "o"));
}

}  // namespace
}  // namespace leviosim::tools
