// `leviosim benchmark-flights` as users meet it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "tests/support/run_program.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/table/table_files.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using base::read_text_file;
using testing::expect_refused;
using testing::ProgramResult;
using testing::run_program;
using traces::testing::AslFolder;
using traces::testing::contents;
using traces::testing::TempFolder;

/// Drawn flights are kept in a folder of the test's own.
class BenchmarkFlights : public ::testing::Test {
 protected:
  BenchmarkFlights() {
    if (const char* before = std::getenv("XDG_CACHE_HOME")) before_ = before;
    ::setenv("XDG_CACHE_HOME", (folder_ / "cache").c_str(), 1);
  }
  ~BenchmarkFlights() override {
    if (before_)
      ::setenv("XDG_CACHE_HOME", before_->c_str(), 1);
    else
      ::unsetenv("XDG_CACHE_HOME");
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// The motion is called `motion`.
  std::vector<std::string> words(const std::string& plan, const std::string& out,
                                 const std::vector<std::string>& further = {}) const {
    outputs::write_file_atomically(folder_ / "plan.yaml",
                                   "motions: [motion]\nworlds: { one: [1], other: [2] }\n" + plan);
    std::vector<std::string> all{"benchmark-flights",     path("plan.yaml"), "--motions",
                                 folder_.path().string(), "--out",           path(out)};
    all.insert(all.end(), further.begin(), further.end());
    return all;
  }
  ProgramResult run(const std::vector<std::string>& words) const {
    return run_program(folder_.path(), words);
  }
  std::size_t drawn() const {
    std::size_t count = 0;
    std::error_code none;  // at first there is no folder
    for (const auto& entry : fs::directory_iterator(folder_ / "cache/leviosim/rendered", none))
      count += entry.is_directory() ? 1 : 0;
    return count;
  }

  TempFolder folder_;
  std::optional<std::string> before_;
};

/// Six frames of 32x24.
class BenchmarkOfFewFrames : public BenchmarkFlights {
 protected:
  BenchmarkOfFewFrames() { fs::create_directory_symlink(data_.root(), folder_ / "motion"); }
  static constexpr const char* kPlan = "pieces: [3]\nevery: 0.1\nsize: 32x24\nseeds: [1, 2]\n";
  AslFolder data_;
};

TEST_F(BenchmarkOfFewFrames, RefusesBadInputBeforeAnythingIsDrawn) {
  const auto refuse = [&](const std::vector<std::string>& further,
                          const std::vector<std::string>& parts) {
    expect_refused(run(words(kPlan, "out", further)), parts);
  };
  expect_refused(run({"benchmark-flights"}), {"PLAN is missing"});
  expect_refused(run({"benchmark-flights", "mid-air"}), {"--motions is missing"});
  expect_refused(run({"benchmark-flights", "mid-air", "--motions", "x"}), {"--out is missing"});
  expect_refused(run({"benchmark-flights", "mid-iar", "--motions", "x", "--out", path("out")}),
                 {"'mid-iar'", "did you mean 'mid-air'"});
  expect_refused(
      run({"benchmark-flights", "mid-air", "--motions", path("none"), "--out", path("out")}),
      {"none/MH_01_easy"});
  refuse({"--profile", "nxet"}, {"nxet"});
  refuse({"--profile", "next,next"}, {"--profile 'next'", "twice"});
  refuse({"--seed", "1,1"}, {"--seed '1'", "twice"});
  refuse({"--jobs", "0"}, {"--jobs '0'"});
  refuse({"-p", "cluster.workers=4"}, {"cluster.workers=4", "without a chip"});
  refuse({"-p", "workload.windw=4"}, {"did you mean 'workload.window'"});
  expect_refused(run(words(std::string(kPlan) + "variants: [{ workload.window: 8 }]", "out",
                           {"-p", "workload.window=6"})),
                 {"-p workload.window=6", "the plan sets it itself", "next window=8"});
  expect_refused(run(words("pieces: [50]\nevery: 0.1\nsize: 32x24", "out")), {"no piece"});
  expect_refused(run(words("pieces: [3]\nevery: 0.1\nsize: 64x48", "out")), {"64x48", "32x24"});
  fs::create_directory(folder_ / "mine");
  outputs::write_file_atomically(folder_ / "mine/thesis.tex", "mine");
  expect_refused(run(words(kPlan, "mine", {"--force"})), {"something other than results"});
  expect_refused(run(words(kPlan, "motion", {"--force"})), {"motion"});
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  EXPECT_EQ(drawn(), 0u);
}

/// The system ends a program that goes on looking for pieces.
TEST_F(BenchmarkOfFewFrames, RefusesStepsBeyondADay) {
  for (const char* every : {"1e10", "1e300", "1e-300"}) {
    const std::string plan = fmt::format("pieces: [3]\nevery: {}\nsize: 32x24\n", every);
    const ProgramResult result =
        testing::Program(folder_.path(), words(plan, "out", {"--list"}), {.cpu_seconds = 2}).wait();
    expect_refused(result, {"every", every, "expected 0.01 to 86400 s"});
  }
}

TEST_F(BenchmarkOfFewFrames, ListsItsPiecesWithoutDrawingThem) {
  const ProgramResult listed = run(words(kPlan, "out", {"--list"}));
  EXPECT_EQ(listed.status, 0) << listed.err;
  EXPECT_EQ(listed.out,
            "one\tmotion\tworld 1\t2:5\t0.10 s\t2.00 m\nother\tmotion\tworld 2\t2:5\t0.10 s\t"
            "2.00 m\n");
  EXPECT_EQ(drawn(), 0u);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(BenchmarkOfFewFrames, GoesOnWhereItWasAndDrawsNothingTwice) {
  const ProgramResult first = run(words(kPlan, "out", {"--seed", "1", "--jobs", "1"}));
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(drawn(), 2u);
  std::set<std::string> pictures;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "cache/leviosim/rendered"))
    if (entry.path().extension() == ".png") pictures.insert(read_text_file(entry.path()));
  EXPECT_EQ(pictures.size(), 6u) << "three of each world";
  const ProgramResult more = run(words(kPlan, "more", {"--report", path("page.html")}));
  ASSERT_EQ(more.status, 0) << more.err;
  EXPECT_NE(more.err.find("run 4/4, 2 of them done before"), std::string::npos) << more.err;
  EXPECT_EQ(drawn(), 2u);
  const auto files = contents(folder_ / "more");
  for (const char* name : {"runs.csv", "pieces.csv", "rows.csv", "table.md", "manifest.json"})
    EXPECT_TRUE(files.count(name)) << name;
  const std::string page = read_text_file(folder_ / "page.html");
  const std::string data = page.substr(page.find("id=\"data\">"));
  for (const char* part : {"ate_percent", "\"title\":\"Flights: plan\"", "\"mark\":\"Answer\"",
                           "\"found\":[{\"title\":\"Each profile on each set of flights\""})
    EXPECT_NE(data.find(part), std::string::npos) << part;
  EXPECT_EQ(data.find("───"), std::string::npos) << "a table as text";

  // What is finished needs no pictures.
  fs::remove_all(folder_ / "cache/leviosim/rendered");
  const ProgramResult again = run(words(kPlan, "again", {"--jobs", "1"}));
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(drawn(), 0u);
  for (const char* name : {"runs.csv", "pieces.csv", "rows.csv", "table.md"})
    EXPECT_EQ(read_text_file(folder_ / "again" / name), files.at(name)) << name;
  const ProgramResult json = run(words(kPlan, "json", {"--json"}));
  EXPECT_EQ(Json::parse(json.out).at("rows"),
            rows_json(read_csv("rows.csv", files.at("rows.csv"))));
}

TEST_F(BenchmarkOfFewFrames, DrawsAFlightAnewThatWasChanged) {
  ASSERT_EQ(run(words(kPlan, "out", {"--seed", "1"})).status, 0);
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "cache/leviosim/rendered"))
    if (entry.path().extension() == ".png") outputs::write_file_atomically(entry.path(), "spoilt");
  const ProgramResult more = run(words(kPlan, "more", {"--seed", "2"}));
  EXPECT_EQ(more.status, 0) << more.err;
}

/// A piece of which nothing else is drawn is the piece of the whole flight.
TEST_F(BenchmarkFlights, APieceDrawnAloneIsThatOfTheWhole) {
  traces::write_synthetic_flight(folder_ / "motion", {.duration_s = 3.2, .texel_m = 0.05});
  const auto rows = [&](const std::string& pieces, const std::string& out) {
    std::vector<std::string> all = words(
        "every: 1\npieces: " + pieces, out,
        {"--seed", "1", "--profile", "levio,next", "--quiet", "--cache", path(out + "-runs")});
    const ProgramResult result = run(all);
    EXPECT_EQ(result.status, 0) << result.err;
    std::vector<Json> found;
    const std::string csv = read_text_file(folder_ / out / "pieces.csv");
    for (const Json& piece : rows_json(read_csv("pieces.csv", csv)))
      if (piece.at("piece") == "25 frames") found.push_back(piece);
    return found;
  };
  const std::vector<Json> alone = rows("[25]", "alone");
  const std::vector<Json> of_whole = rows("[25, whole]", "whole");
  EXPECT_EQ(drawn(), 4u);
  ASSERT_FALSE(alone.empty());
  EXPECT_EQ(alone, of_whole);
  for (const Json& piece : alone) {
    EXPECT_TRUE(piece.at("ate_m").is_number() || piece.at("diverged") == 1) << piece;
    EXPECT_GT(piece.at("path_m"), 0);
  }
}

}  // namespace
}  // namespace leviosim::tools
