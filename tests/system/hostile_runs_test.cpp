// Run folders that a stranger made: what a gate reads is what the run wrote.
#include <gtest/gtest.h>

#include "tests/support/program_suite.h"
#include "tests/support/scratch.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::ProgramResult;
using tests::read_text;
using tests::write_text;

class HostileRuns : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("hostile-runs");
    traces::write_synthetic_flight(path("flight"), {.duration_s = 0.5, .texel_m = 0.05});
    expect_done(
        {"run", "--platform", "gap9", "--data", path("flight"), "--out", path("clean"), "--quiet"});
    expect_done({"run", "--platform", "gap9", "--data", path("flight"), "--out", path("camera"),
                 "--fps", "20", "--deadline", "drop", "--quiet"});
    write_text(path("budgets.yaml"), "budgets: [{ limits: [frame latency p99 <= 9 s] }]\n");
  }
  void SetUp() override { fs::copy(path("clean"), path("run")); }
  void TearDown() override {
    fs::remove_all(path("run"));
    fs::remove(path("r.html"));
  }

  static std::vector<std::vector<std::string>> readers() {
    return {{"check", path("run"), "--budget", path("budgets.yaml")},
            {"check", path("clean"), "--budget", path("budgets.yaml"), "--baseline", path("run")},
            {"compare", path("clean"), path("run")},
            {"budget", "record", path("run")},
            {"report", path("run"), "--out", path("r.html")}};
  }
  static void expect_refused_by_all(const std::vector<std::string>& parts) {
    for (const std::vector<std::string>& words : readers()) {
      SCOPED_TRACE(words[0] + ' ' + words.back());
      expect_refused(program(words), parts);
    }
    EXPECT_FALSE(fs::exists(path("r.html")));
  }
  static void expect_read_by_all() {
    for (const std::vector<std::string>& words : readers()) {
      const ProgramResult result = program(words);
      EXPECT_EQ(result.status, 0) << words[0] << ' ' << words.back() << result.err;
    }
    fs::remove(path("r.html"));
  }
  static std::string first_lines(const std::string& text, int lines) {
    std::size_t end = 0;
    for (; lines > 0; --lines) end = text.find('\n', end) + 1;
    return text.substr(0, end);
  }
};

TEST_F(HostileRuns, WhatWasChangedAfterTheRunIsNotRead) {
  for (const char* name :
       {"frames.csv", "stats.json", "manifest.json", "cycles.csv", "stages.csv", "memory.csv"}) {
    const std::string text = read_text(path("run") + '/' + name);
    for (const std::string& changed : {first_lines(text, 4), text + ' '}) {
      write_text(path("run") + '/' + name, changed);
      expect_refused_by_all({name, "expected", ".leviosim-files"});
    }
    write_text(path("run") + '/' + name, text);
  }
  fs::remove(path("run/cycles.csv"));
  expect_refused_by_all({"cycles.csv", "missing", ".leviosim-files"});
}

TEST_F(HostileRuns, WithoutARecordThereAreAsManyFramesAsTheManifestSays) {
  for (const char* run : {"clean", "camera"}) {
    fs::remove_all(path("run"));
    fs::copy(path(run), path("run"));
    fs::remove(path("run/.leviosim-files"));
    const std::string text = read_text(path("run/frames.csv"));
    const auto rows = std::count(text.begin(), text.end(), '\n') - 1;
    if (run == std::string("clean")) expect_read_by_all();
    write_text(path("run/frames.csv"), first_lines(text, 4));
    expect_refused_by_all({"frames.csv", "3 frames", "expected " + std::to_string(rows)});
    write_text(path("run/frames.csv"), text.substr(0, text.size() - 2));
    expect_refused_by_all({"frames.csv", "cut off"});
    write_text(path("run/frames.csv"), text + "#" + text.substr(text.rfind('\n', text.size() - 2)));
    expect_refused_by_all({"frames.csv", "expected " + std::to_string(rows)});
  }
}

/// Whoever puts a report into a folder of copied files makes a record, which says nothing of them.
TEST_F(HostileRuns, RecordsOfOtherFilesSayNothingOfTheRun) {
  fs::remove(path("run/.leviosim-files"));
  expect_done({"report", path("run"), "--out", path("run/r.html")});
  ASSERT_TRUE(fs::exists(path("run/.leviosim-files")));
  expect_read_by_all();
}

}  // namespace
}  // namespace leviosim::tools
