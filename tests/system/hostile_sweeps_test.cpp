// Sweeps that a stranger made: what their lines say deletes nothing, keeps nobody waiting, and
// takes no memory.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <thread>

#include "tests/support/program_suite.h"
#include "tests/support/scratch.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::Program;
using testing::ProgramLimits;
using testing::ProgramResult;
using tests::picture_of;
using tests::read_text;
using tests::write_text;

class HostileSweeps : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("hostile-sweeps");
    traces::write_synthetic_flight(path("flight"), {.duration_s = 0.5, .texel_m = 0.05});
    expect_done({"run", "--platform", "gap9", "--data", path("flight"), "--record", "--out",
                 path("recorded"), "--quiet"});
    write_text(path("plan.yaml"),
               "base: { trace: recorded }\n"
               "points: { grid: { platform.cluster.clock: [200, 370] } }\n");
    write_text(path("budgets.yaml"), "budgets: [{ limits: [L1 peak <= 1 MB] }]\n");
    expect_done(sweep("clean"));
  }
  void SetUp() override {
    fs::copy(path("clean"), path("sw"));
    write_text(path("thesis.tex"), "mine");
  }
  void TearDown() override {
    fs::remove_all(path("sw"));
    fs::remove_all(path("all"));
  }

  static std::vector<std::string> sweep(const std::string& out, const std::string& further = {}) {
    std::vector<std::string> words{"sweep",   path("plan.yaml"), "--out",      path(out),
                                   "--quiet", "--cache",         path("cache")};
    if (!further.empty()) words.push_back(further);
    return words;
  }
  static std::vector<std::vector<std::string>> readers() {
    std::vector<std::string> budget = sweep("sw", "--budget");
    budget.push_back(path("budgets.yaml"));
    return {{"compare", path("sw") + ":1", path("sw") + ":2", "--quiet"},
            sweep("sw"),
            sweep("sw", "--force"),
            budget,
            {"sweep", "--merge", path("all"), path("sw"), path("clean")},
            {"sweep", "--merge", path("sw"), path("clean"), path("clean")}};
  }
  static ProgramResult limited(const std::vector<std::string>& words) {
    return Program(folder_->path(), words, {.cpu_seconds = 10, .data_bytes = 400'000'000}).wait();
  }
  /// Every command that opens the file refuses it, soon, and changes nothing.
  /// @param begins_ours  so that --force may begin anew
  static void expect_refused_by_all(const std::vector<std::string>& parts,
                                    bool begins_ours = false) {
    for (const std::vector<std::string>& words : readers()) {
      if (begins_ours && words.back() == "--force") continue;
      fs::remove_all(path("all"));
      const auto before = picture_of(path("sw"));
      const ProgramResult result = limited(words);
      EXPECT_EQ(read_text(path("thesis.tex")), "mine") << words[0] << ' ' << words.back();
      if (words[1] == "--merge" && words[2] == path("all"))
        EXPECT_EQ(result.status, 2) << result.err;
      else
        expect_refused(result, parts);
      EXPECT_EQ(picture_of(path("sw")), before) << words[0] << ' ' << words.back();
      write_text(path("thesis.tex"), "mine");
    }
  }
};

TEST_F(HostileSweeps, PipesAreNotWaitedFor) {
  fs::remove(path("sw/points.jsonl"));
  ASSERT_EQ(::mkfifo((path("sw/points.jsonl")).c_str(), 0600), 0);
  for (const std::vector<std::string>& words : readers()) {
    Program program(folder_->path(), words);
    for (int tries = 0; tries < 500 && program.running(); ++tries)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_FALSE(program.running()) << words[0] << " waits for a FIFO";
    program.send(SIGKILL);
    EXPECT_EQ(program.wait().status, 2);
  }
}

/// Lines that name a thing a million times, nest without end, or have no end.
TEST_F(HostileSweeps, LinesAreBounded) {
  const std::string clean = read_text(path("clean/points.jsonl"));
  const std::string first = clean.substr(0, clean.find('\n') + 1);
  std::string many = "{\"point\":1,\"key\":\"k\",\"set\":[";
  for (int i = 0; i < 200'000; ++i) many += "[\"a\",\"b\"],";
  std::string members = "{\"point\":1";
  for (int i = 0; i < 100'000; ++i) members += fmt::format(",\"m{}\":0", i);
  for (const std::string& line :
       {many + "[]]}", members + "}", std::string(60'000, '['),
        "{\"a\":" + std::string(1'000'000, '[') + std::string(1'000'000, ']') + "}",
        std::string(40 << 20, ' ')}) {
    write_text(path("sw/points.jsonl"), first + line + "\n");
    expect_refused_by_all({"points.jsonl"}, true);
  }
  write_text(path("sw/points.jsonl"),
             "{\"sweep\":\"leviosim sweep 3\",\"points\":9999999999999,\"keys\":\"k\"}\n");
  expect_refused_by_all({"points.jsonl"}, true);
}

/// What a data base of an earlier version was, whatever is in it.
TEST_F(HostileSweeps, OldSweepsAreRefusedUnread) {
  fs::remove(path("sw/points.jsonl"));
  write_text(path("sw/sweep.sqlite"), std::string(155'000, '\1'));
  expect_refused_by_all({"sweep.sqlite", "earlier leviosim"});
}

/// A sweep goes on in no folder of a run, and takes no file of a user.
TEST_F(HostileSweeps, FoldersOfRunsAndNeighboursStay) {
  const auto before = picture_of(path("recorded"));
  for (const char* further : {"", "--force"})
    expect_refused(limited(sweep("recorded", further)), {"something other than a sweep"});
  EXPECT_EQ(picture_of(path("recorded")), before);
  for (const char* name :
       {"sweep.sqlite-journal", "sweep.sqlite", "points.jsonl-journal", "points.jsonl~"}) {
    write_text(path("sw/") + name, "mine");
    for (const char* further : {"", "--force"})
      expect_refused(limited(sweep("sw", further)), {name});
    EXPECT_EQ(read_text(path("sw/") + name), "mine");
    fs::remove(path("sw/") + name);
  }
}

TEST_F(HostileSweeps, LaterVersionsAreNotGoneOnWith) {
  std::string text = read_text(path("sw/points.jsonl"));
  text.replace(text.find("sweep 4"), 7, "sweep 99");
  write_text(path("sw/points.jsonl"), text);
  expect_refused(limited(sweep("sw")), {"version", "leviosim sweep 4"});
}

}  // namespace
}  // namespace leviosim::tools
