// Run folders, budgets and baselines that a stranger made: what a gate reads is what the run wrote,
// and what it prints obeys nobody.
#include <gtest/gtest.h>

#include "tests/support/program_suite.h"
#include "tests/support/scratch.h"
#include "tools/app/record/statistic_list.h"
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
  static void expect_no_page(const std::vector<std::string>& parts) {
    expect_refused(program(readers().back()), parts);
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
  for (const char* name : {"run.json"}) {
    const std::string text = read_text(path("run") + '/' + name);
    for (const std::string& changed : {first_lines(text, 4), text + ' '}) {
      write_text(path("run") + '/' + name, changed);
      expect_refused_by_all({name, "expected", ".leviosim-files"});
    }
    write_text(path("run") + '/' + name, text);
  }
  fs::remove(path("run/run.json"));
  expect_refused_by_all({"run.json", "missing", ".leviosim-files"});
}

/// Tables are for pages and for people.
TEST_F(HostileRuns, TablesThatWereChangedMakeNoPage) {
  for (const char* name : {"frames.csv", "manifest.json", "stages.csv", "memory.csv"}) {
    const std::string text = read_text(path("run") + '/' + name);
    for (const std::string& changed : {first_lines(text, 4), text + ' '}) {
      write_text(path("run") + '/' + name, changed);
      expect_no_page({name, "expected", ".leviosim-files"});
    }
    write_text(path("run") + '/' + name, text);
  }
  fs::remove(path("run/memory.csv"));
  expect_no_page({"memory.csv", "missing", ".leviosim-files"});
}

TEST_F(HostileRuns, WithoutARecordOfFilesThereAreAsManyFramesAsTheRunSays) {
  for (const char* run : {"clean", "camera"}) {
    fs::remove_all(path("run"));
    fs::copy(path(run), path("run"));
    fs::remove(path("run/.leviosim-files"));
    const std::string text = read_text(path("run/frames.csv"));
    const auto rows = std::count(text.begin(), text.end(), '\n') - 1;
    if (run == std::string("clean")) expect_read_by_all();
    write_text(path("run/frames.csv"), first_lines(text, 4));
    expect_no_page({"frames.csv", "3 frames", "expected " + std::to_string(rows)});
    write_text(path("run/frames.csv"), text.substr(0, text.size() - 2));
    expect_no_page({"frames.csv", "cut off"});
    write_text(path("run/frames.csv"), text + "#" + text.substr(text.rfind('\n', text.size() - 2)));
    expect_no_page({"frames.csv", "expected"});
  }
}

/// Whoever puts a report into a folder of copied files makes a record, which says nothing of them.
TEST_F(HostileRuns, RecordsOfOtherFilesSayNothingOfTheRun) {
  fs::remove(path("run/.leviosim-files"));
  expect_done({"report", path("run"), "--out", path("run/r.html")});
  ASSERT_TRUE(fs::exists(path("run/.leviosim-files")));
  expect_read_by_all();
}

/// Lines that a server of CI would obey.
std::vector<std::string> commands_in(const std::string& text) {
  std::vector<std::string> commands;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.find("##[") != std::string::npos || line.find("##vso[") != std::string::npos ||
        line.find("::") == line.find_first_not_of(" \t"))
      commands.push_back(line);
  std::erase(commands, "");
  return commands;
}

TEST_F(HostileRuns, LinesOfOthersAreNoCommandsOfServers) {
  const std::string words = std::string(65, 'x') + " ::stop-commands::x ##[error]y ##vso[z]";
  write_text(
      path("hostile.yaml"),
      "budgets:\n  - limits:\n      - limit: L1 peak <= 1 kB\n        reason: \"a\\n::error::b " +
          words + "\"\n        owner: \"\\n::set-env name=x::y\\n##[group]z " + words +
          "\"\n      - { stage: \"*\", limit: cycles <= 1 cycles }\n    name: \"::warning::x\"\n");
  fs::remove(path("run/.leviosim-files"));
  for (const char* name : {"run.json", "stages.csv", "memory.csv", "energy.csv"}) {
    std::string text = read_text(path("run") + '/' + name);
    for (const auto& [stage, other] : {std::pair{"feature extraction", "::feature::extraction"},
                                       std::pair{"frame matching", "##[frame]matching"}})
      for (std::size_t at = 0; (at = text.find(stage, at)) != std::string::npos;)
        text.replace(at, std::string(stage).size(), other);
    write_text(path("run") + '/' + name, text);
  }
  const std::vector<std::string> check{"check", path("run"), "--budget", path("hostile.yaml")};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), check.begin(), check.end());
    return more;
  };
  const std::vector<std::string> github = with({"--annotations", "github"});
  for (const std::vector<std::string>& line : std::vector<std::vector<std::string>>{
           check,
           github,
           with({"--annotations", "gitlab"}),
           with({"--json"}),
           {"compare", path("clean"), path("run")},
           {"compare", path("clean"), path("run"), "--format", "markdown"},
           {"compare", path("clean"), path("run"), "--format", "csv"},
           {"check", "::error::x", "--budget", "##[error]y"},
           {"check", path("run"), "--budget", "x ##vso[task.complete result=Succeeded;]"},
           {"report", path("run"), "--out", path("##[error]/x")}}) {
    const ProgramResult result = program(line);
    std::vector<std::string> commands = commands_in(result.out + result.err);
    if (line == github)
      std::erase_if(commands, [](const std::string& c) { return c.starts_with("::error file="); });
    EXPECT_EQ(commands, std::vector<std::string>()) << line[0] << ' ' << line.back();
  }
  EXPECT_NE(program(github).out.find("\n::error file="), std::string::npos);
  const std::string json = program(with({"--json"})).out;
  EXPECT_NE(Json::parse(json).dump().find("##[group]z"), std::string::npos) << "is data as it was";
}

TEST_F(HostileRuns, BarsDoNotSplitCellsOfMarkdown) {
  fs::remove(path("run/.leviosim-files"));
  std::string text = read_text(path("run/run.json"));
  for (std::size_t at = 0; (at = text.find("feature extraction", at)) != std::string::npos;)
    text.replace(at, 18, "feature|extraction\\\\|");
  write_text(path("run/run.json"), text);
  const ProgramResult result =
      program({"compare", path("run"), path("run"), "--format", "markdown"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("| feature\\|extraction\\\\\\| |"), std::string::npos) << result.out;
}

TEST_F(HostileRuns, BaselinesHaveWholeNumbersAndNothingBehindTheirEnd) {
  const std::string good = program({"budget", "record", path("run")}).out;
  const auto check = [&](const std::string& baseline) {
    write_text(path("baseline.json"), baseline);
    return program({"check", path("run"), "--budget", path("budgets.yaml"), "--baseline",
                    path("baseline.json")});
  };
  EXPECT_EQ(check(good).status, 0);
  for (const char* seed : {"1.5", "1.0", "4294967297", "-1", "\"1\""}) {
    std::string other = good;
    expect_refused(
        check(other.replace(other.find("\"seed\": 1"), 9, std::string("\"seed\": ") + seed)),
        {"baseline.json"});
  }
  expect_refused(check(good + '\0'), {"baseline.json"});
  expect_refused(check(good + '\0' + "x"), {"baseline.json"});
}

TEST_F(HostileRuns, TwoOutputsHaveTwoNames) {
  for (const char* other : {"x", "./x", "../hostile-twin/x"}) {
    fs::create_directory_symlink(folder_->path(), path("../hostile-twin"));
    expect_refused(program({"check", path("run"), "--budget", path("budgets.yaml"), "--report",
                            path("x"), "--junit", path(other)}),
                   {"--report", "--junit", "x", "two files"});
    fs::remove(path("../hostile-twin"));
    EXPECT_FALSE(fs::exists(path("x")));
  }
}

}  // namespace
}  // namespace leviosim::tools
