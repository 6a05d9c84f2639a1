// A history while other programs rename, link and replace it: no run of any file is lost, and what
// is none of leviosim's stays as it is.
#include <gtest/gtest.h>
#include <sys/file.h>

#include <thread>

#include "sim/outputs/file_system.h"
#include "tests/support/program_suite.h"
#include "tests/support/scratch.h"
#include "tools/app/history/history.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::Program;
using testing::ProgramResult;
using tests::read_text;
using tests::write_text;

class HostileHistories : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("hostile_histories");
    traces::write_synthetic_flight(*folder_ / "flight", {.duration_s = 0.3, .texel_m = 0.02});
    expect_done(
        {"run", "--platform", "gap9", "--data", path("flight"), "--out", path("run"), "--quiet"});
    const ProgramResult baseline = program({"budget", "record", path("run")});
    ASSERT_EQ(baseline.status, 0) << baseline.err;
    write_text(*folder_ / "baseline.json", baseline.out);
  }
  void SetUp() override {
    for (const char* name : {"history", "moved", "other"}) fs::remove(path(name));
  }
  static std::vector<std::string> words(int n) {
    return {"history",
            "add",
            path("baseline.json"),
            "--file",
            path("history"),
            "--commit",
            fmt::format("c{}", n),
            "--branch",
            "main",
            "--time",
            fmt::format("{}", n),
            "--subject",
            "s"};
  }
  static ProgramResult add(int n) { return program(words(n)); }
  static std::string history() { return read_text(path("history")); }

  /// Adds a run while another program has the lock, does something, and lets go.
  template <class Meanwhile>
  static ProgramResult add_while(int n, const Meanwhile& meanwhile) {
    const outputs::Descriptor held(::open(path("history").c_str(), O_RDWR | O_CLOEXEC));
    EXPECT_EQ(::flock(held.get(), LOCK_EX), 0);
    Program adding(folder_->path(), words(n));
    wait_until_open(adding.id(), path("history"));
    meanwhile();
    ::flock(held.get(), LOCK_UN);
    return adding.wait();
  }
  static void wait_until_open(pid_t program, const fs::path& file) {
    const fs::path descriptors = fmt::format("/proc/{}/fd", program);
    for (int tries = 0; tries < 1000; ++tries) {
      std::error_code error;
      for (const fs::directory_entry& entry : fs::directory_iterator(descriptors, error))
        if (fs::read_symlink(entry, error) == fs::canonical(file)) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "it never opened " << file;
  }
};

TEST_F(HostileHistories, ARotatedHistoryLosesNoRun) {
  for (int n = 1; n <= 6; ++n) ASSERT_EQ(add(n).status, 0);
  const std::string six = history();
  const ProgramResult result = add_while(7, [&] {
    fs::rename(path("history"), path("moved"));
    write_text(path("history"), "");
  });
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(read_text(path("moved")), six);
  EXPECT_EQ(History::read(path("history")).size(), 1u);
}

TEST_F(HostileHistories, AMovedHistoryIsBegunAnew) {
  for (int n = 1; n <= 3; ++n) ASSERT_EQ(add(n).status, 0);
  const std::string three = history();
  const ProgramResult result = add_while(4, [&] { fs::rename(path("history"), path("moved")); });
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(read_text(path("moved")), three);
  EXPECT_EQ(History::read(path("history")).size(), 1u);
}

/// As a backup of links does, before an older one is put in place.
TEST_F(HostileHistories, ALinkedBackupKeepsItsRuns) {
  ASSERT_EQ(add(1).status, 0);
  const std::string one = history();
  for (int n = 2; n <= 6; ++n) ASSERT_EQ(add(n).status, 0);
  const std::string six = history();
  const ProgramResult result = add_while(7, [&] {
    fs::create_hard_link(path("history"), path("moved"));
    write_text(path("other"), one);
    fs::rename(path("other"), path("history"));
  });
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(read_text(path("moved")), six);
  EXPECT_EQ(History::read(path("history")).size(), 2u);
}

TEST_F(HostileHistories, AFileOfTwoNamesIsRefused) {
  ASSERT_EQ(add(1).status, 0);
  const std::string one = history();
  fs::create_hard_link(path("history"), path("moved"));
  expect_refused(add(2), {"history", "2 names"});
  EXPECT_EQ(read_text(path("moved")), one);
  fs::remove(path("moved"));
  const ProgramResult meanwhile =
      add_while(2, [&] { fs::create_hard_link(path("history"), path("moved")); });
  expect_refused(meanwhile, {"history", "2 names"});
  EXPECT_EQ(read_text(path("moved")), one);
}

/// A link to the history leads to it, and to the other file once it was made to.
TEST_F(HostileHistories, ALinkThatIsTurnedLeadsToTheOther) {
  ASSERT_EQ(add(1).status, 0);
  fs::rename(path("history"), path("moved"));
  fs::create_symlink("moved", path("history"));
  ASSERT_EQ(add(2).status, 0);
  const std::string two = read_text(path("moved"));
  EXPECT_EQ(History::read(path("moved")).size(), 2u);
  write_text(path("other"), "");
  const ProgramResult result = add_while(3, [&] {
    fs::remove(path("history"));
    fs::create_symlink("other", path("history"));
  });
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(read_text(path("moved")), two);
  EXPECT_EQ(History::read(path("other")).size(), 1u);
}

TEST_F(HostileHistories, AForeignLineThatLacksItsEndStays) {
  for (const char* text : {"{", "{\"", "{\"kept\":\"", "{\"kept\":\"my own notes",
                           "{\"run\":\"5 km", "{\"run\":\"today\",\"time\":1", " {\"run\":\""}) {
    write_text(path("history"), text);
    expect_refused(add(1), {"history"});
    EXPECT_EQ(history(), text);
  }
}

}  // namespace
}  // namespace leviosim::tools
