// validate and sensitivity as users meet them.
#include <gtest/gtest.h>

#include <cstdlib>

#include "platform_models/loader/loader.h"
#include "tests/support/run_program.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::ProgramResult;
using testing::run_program;
using traces::testing::TempFolder;

class StudyCommands : public ::testing::Test {
 protected:
  void expect_refusal(const std::vector<std::string>& words,
                      const std::vector<std::string>& parts) {
    testing::expect_refused(run_program(folder_.path(), words), parts);
  }
  /// Besides what the program printed.
  std::vector<std::string> files_left() const {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path()))
      if (entry.path().extension() != ".txt") names.push_back(entry.path().filename().string());
    return names;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  TempFolder folder_;
};

TEST_F(StudyCommands, RefuseBadInputBeforeTheRun) {
  for (const char* command : {"validate", "sensitivity"}) {
    expect_refusal({command, "--data", path("nowhere"), "--quiet"}, {"nowhere"});
    expect_refusal({command, "--platfrom", "gap9"}, {"did you mean '--platform'"});
    expect_refusal({command, "--platform", "gap99"}, {"gap99", "did you mean 'gap9'"});
    expect_refusal({command, "--frames", "9:3", "--data", path("nowhere")}, {"'9:3'"});
    expect_refusal({command, "--cores", "0", "--data", path("nowhere")}, {"--cores '0'"});
    expect_refusal({command, "-p", "cluster.fpus=2", "--data", path("nowhere")}, {"cluster.fpus"});
  }
  EXPECT_TRUE(files_left().empty());
}

/// Of files that are older, and of -p.
TEST_F(StudyCommands, SayWhatHasBecomeOfTheFittedConstant) {
  expect_refusal({"validate", "-p", "isa.instruction_overhead=1.2", "--data", path("x")},
                 {"-p isa.instruction_overhead=1.2", "no such key any more", "delete it"});
  outputs::write_file_atomically(folder_ / "older.yaml",
                                 "extends: gap9\nisa:\n  instruction_overhead: 1.16\n");
  expect_refusal({"platforms", "show", path("older.yaml")},
                 {"older.yaml", ":3: ", "isa.instruction_overhead", "no such key any more"});
}

/// Chips that are worse than the program's own, in a unit and in a row that is known to be missed.
TEST_F(StudyCommands, MicrobenchFailsWhereARowIsBeyondItsToleranceOrItsGuard) {
  EXPECT_EQ(run_program(folder_.path(), {"microbench"}).status, 0);
  const ProgramResult divider =
      run_program(folder_.path(), {"microbench", "-p", "cluster.fpu.dividers=2"});
  EXPECT_EQ(divider.status, 1) << divider.err;
  EXPECT_NE(divider.out.find("warning: shared units, fp32 div, cores 8: error -"),
            std::string::npos)
      << divider.out;
  EXPECT_NE(divider.out.find("beyond its tolerance of 5 %"), std::string::npos) << divider.out;
  const ProgramResult loads =
      run_program(folder_.path(), {"microbench", "--platform", "gap8", "-p",
                                   "isa.load_use_fraction=0.4", "--csv", path("rows.csv")});
  EXPECT_EQ(loads.status, 1) << loads.err;
  EXPECT_NE(loads.out.find("warning: 5x5 convolution 112x112, scalar, cores 1: error +"),
            std::string::npos)
      << loads.out;
  EXPECT_NE(loads.out.find("beyond its guard of 14 %"), std::string::npos) << loads.out;
  EXPECT_NE(base::read_text_file(folder_ / "rows.csv").find(",worse,"), std::string::npos);
}

/// The chip of the library's figures has values of its own for some keys.
TEST_F(StudyCommands, MicrobenchTakesAnyKey) {
  for (const char* set :
       {"cluster.l1.size=64KiB", "cluster.fpu.units=2", "isa.load_use_fraction=0"})
    EXPECT_EQ(run_program(folder_.path(), {"microbench", "-p", set}).err, "") << set;
}

TEST_F(StudyCommands, ReplaceNothingUnlessForced) {
  outputs::write_file_atomically(folder_ / "mine.yaml", "mine");
  fs::create_directory(folder_ / "folder");
  outputs::write_file_atomically(folder_ / "folder/thesis.tex", "mine");
  expect_refusal({"sensitivity", "--data", "x", "--csv", path("mine.yaml"), "--force"}, {"exists"});
  expect_refusal({"sensitivity", "--data", "x", "--csv", path("folder")}, {"is a folder"});
  expect_refusal({"sensitivity", "--data", "x", "--csv", path("none/a.csv")}, {"no folder"});
  expect_refusal({"validate", "--data", "x", "--out", path("folder"), "--force"},
                 {"something other than results"});
  EXPECT_EQ(base::read_text_file(folder_ / "mine.yaml"), "mine");
  EXPECT_TRUE(fs::exists(folder_ / "folder/thesis.tex"));
}

/// One flight for everything that runs to its end.
TEST_F(StudyCommands, RunOnASyntheticFlight) {
  const TempFolder& work = folder_;
  traces::write_synthetic_flight(work / "flight", {.duration_s = 8, .texel_m = 0.01});
  const std::vector<std::string> data{"--data", path("flight"), "--quiet"};
  const auto words = [&](std::vector<std::string> all) {
    all.insert(all.end(), data.begin(), data.end());
    return all;
  };

  const ProgramResult validated =
      run_program(work.path(), words({"validate", "--out", path("validated")}));
  EXPECT_EQ(validated.status, 1) << "the paper's figures are of another flight" << validated.err;
  EXPECT_NE(validated.out.find("EPnP RANSAC"), std::string::npos);
  EXPECT_NE(validated.out.find("references within their tolerance"), std::string::npos);
  for (const char* name : {"validation.csv", "validation.json", "paper.csv", "manifest.json"})
    EXPECT_TRUE(fs::exists(work / "validated" / name)) << name;

  const ProgramResult swept = run_program(
      work.path(), words({"sensitivity", "--frames", "0:8", "--csv", path("sweep.csv")}));
  EXPECT_EQ(swept.status, 0) << swept.err;
  EXPECT_NE(swept.out.find("isa.unmeasured_instructions"), std::string::npos);
  EXPECT_TRUE(fs::exists(work / "sweep.csv"));

  ::setenv("COLUMNS", "60", 1);
  const ProgramResult fitted = run_program(work.path(), words({"validate", "--fit"}));
  ::unsetenv("COLUMNS");
  EXPECT_EQ(fitted.status, 0) << fitted.err;
  std::string rule;
  for (int i = 0; i < 61; ++i) rule += "─";
  EXPECT_EQ(fitted.out.find(rule), std::string::npos) << "a table of more than 60 columns";
  EXPECT_NE(fitted.out.find("a fit would ask for a factor of"), std::string::npos) << fitted.out;

  expect_refusal(words({"validate", "--fit", "--out", path("fitted")}), {"--fit", "--out"});
  // Three frames never come to EPnP.
  expect_refusal(words({"validate", "--fit", "--frames", "0:3"}), {"no frame of the run came to"});
}

}  // namespace
}  // namespace leviosim::tools
