// Steps and drift of figures over runs.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/traces/test_folder.h"
#include "tools/app/history/history_report.h"
#include "tools/app/history/trend.h"
#include "tools/app/html_report/page.h"

namespace leviosim::tools {
namespace {

constexpr const char* kStage = "matching";

/// A run whose stage takes so many cycles, all of them by one mechanism.
PastRun run_of(int number, double cycles) {
  PastRun run;
  run.origin = {fmt::format("c{:039}", number), "main", 1000 + number,
                fmt::format("commit {}", number)};
  run.record.name = fmt::format("c{}", number);
  run.record.facts.profile = "levio";
  run.record.facts.platform = "gap9";
  run.record.facts.frames = 1;
  run.record.stages = {{kStage, kStage, false}};
  run.record.statistics = {{"frames.count", "1", "", 1.0},
                           {"frame.cycles.parallel.mean", "cycles", "", cycles},
                           {"stages.matching.calls", "1", "", 1.0},
                           {"stages.matching.cycles.parallel.mean", "cycles", "", cycles}};
  run.record.cycles = {{kStage, false, cycles, {{"compare", "issue", "popcount", cycles, 100}}}};
  return run;
}

std::vector<PastRun> runs_of(const std::vector<double>& cycles) {
  std::vector<PastRun> runs;
  for (const double c : cycles) runs.push_back(run_of(static_cast<int>(runs.size()), c));
  return runs;
}

Budget budget_of(const std::string& limit) {
  return parse_budget("b.yaml", "budgets:\n  - limits:\n      - " + limit + "\n");
}

constexpr const char* kLimit = "{ stage: matching, limit: cycles <= +1 % }";

TEST(Trends, AChangeBeyondTheLimitIsAStep) {
  const Budget budget = budget_of(kLimit);
  const std::vector<Trend> found = trends(budget, runs_of({1000, 1000, 1030, 1030}));
  ASSERT_EQ(found.size(), 1u);
  ASSERT_EQ(found[0].steps.size(), 1u);
  EXPECT_EQ(found[0].steps[0].run, 2u);
  EXPECT_NEAR(found[0].steps[0].percent, 3, 1e-9);
  EXPECT_TRUE(found[0].drift.empty());
}

TEST(Trends, SmallChangesAreADriftOnceTheyAreBeyondTheLimitTogether) {
  const Budget budget = budget_of(kLimit);
  std::vector<double> cycles{1000};
  for (int n = 1; n <= 10; ++n) {
    cycles.push_back(cycles.back() * 1.002);
    cycles.push_back(cycles.back());
    const Trend trend = trends(budget, runs_of(cycles)).front();
    EXPECT_TRUE(trend.steps.empty());
    EXPECT_EQ(trend.drift.size(), std::pow(1.002, n) > 1.01 ? static_cast<std::size_t>(n) : 0u) << n;
  }
}

TEST(Trends, WhatGoesBackIsNoDrift) {
  const Budget budget = budget_of(kLimit);
  std::vector<double> cycles;
  for (int n = 0; n < 40; ++n) cycles.push_back(n % 2 == 0 ? 1000 : 1009);
  const Trend trend = trends(budget, runs_of(cycles)).front();
  EXPECT_TRUE(trend.steps.empty());
  EXPECT_TRUE(trend.drift.empty());
}

/// A limit from below: less is worse.
TEST(Trends, FollowTheDirectionOfTheLimit) {
  const Budget budget = budget_of("frame cycles >= -1 %");
  EXPECT_EQ(trends(budget, runs_of({1000, 950})).front().steps.size(), 1u);
  EXPECT_TRUE(trends(budget, runs_of({1000, 1050})).front().steps.empty());
}

CheckResult checked(const Budget& budget, const std::vector<PastRun>& before, double now) {
  const RunRecord run = run_of(99, now).record;
  CheckResult result = check_budget(run, budget, &before.back().record);
  add_history(result, run, budget, before);
  return result;
}

TEST(CheckWithHistory, TheRunThatGoesBeyondFailsAndThoseAfterItAreWarned) {
  const Budget budget = budget_of(kLimit);
  const CheckResult within = checked(budget, runs_of({1000, 1004, 1008}), 1009);
  EXPECT_EQ(within.missed() + within.warned(), 0u);
  const CheckResult crossing = checked(budget, runs_of({1000, 1004, 1008}), 1012);
  EXPECT_EQ(crossing.missed(), 1u);
  const Finding& finding = crossing.findings.back();
  EXPECT_EQ(finding.title(), "matching: cycles <= +1 % since c0");
  ASSERT_FALSE(finding.why.empty());
  EXPECT_EQ(finding.why.back(), "drift of +1.20 % in 3 commits from c1 to c99, none above +0.40 %");
  const CheckResult after = checked(budget, runs_of({1000, 1004, 1008, 1012}), 1012);
  EXPECT_EQ(after.missed(), 0u);
  EXPECT_EQ(after.warned(), 1u);
  EXPECT_NE(after.findings.back().excess().find("was over before this change"), std::string::npos);
  EXPECT_EQ(checked(budget, runs_of({1000, 1004, 1008, 1012}), 1013).missed(), 1u) << "worse still";
}

TEST(CheckWithHistory, AStepIsExplainedByItsCommit) {
  const Budget budget = budget_of(kLimit);
  const CheckResult result = checked(budget, runs_of({1000, 1000, 1100, 1100}), 1100);
  ASSERT_EQ(result.warned(), 1u);
  const std::string& why = result.findings.back().why.back();
  for (const char* part : {"step of +10.00 % at c2 (commit 2)", "matching, compare", "popcount"})
    EXPECT_NE(why.find(part), std::string::npos) << why;
}

TEST(History, ReadsBackWhatItWrote) {
  std::string text;
  const std::vector<PastRun> runs = runs_of({1000, 1000, 1030});
  for (const PastRun& run : runs) text += History("h", text).lines_for(run);
  const History history("h", text);
  ASSERT_EQ(history.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const PastRun back = history.run(i);
    EXPECT_EQ(back.origin.commit, runs[i].origin.commit);
    EXPECT_EQ(back.origin.subject, runs[i].origin.subject);
    EXPECT_EQ(back.record.facts, runs[i].record.facts);
    EXPECT_EQ(back.record.value("frame.cycles.parallel.mean"),
              runs[i].record.value("frame.cycles.parallel.mean"));
    EXPECT_EQ(back.record.cycles.front().parts.front().operation, "popcount");
  }
  EXPECT_EQ(history.like(runs[0].record, "", 2).size(), 2u);
  EXPECT_EQ(history.like(runs[0].record, "other", 2).size(), 0u);
  RunRecord other = runs[0].record;
  other.facts.profile = "next";
  EXPECT_TRUE(history.like(other, "", 9).empty());
}

TEST(History, LinesOfTwoHistoriesMayStandTwice) {
  std::string text;
  for (const PastRun& run : runs_of({1000, 1001})) text += History("h", text).lines_for(run);
  EXPECT_EQ(History("h", text + text).size(), 2u);
  EXPECT_EQ(History("h", text).lines_for(run_of(1, 1001)), "");
  EXPECT_THROW((void)History("h", text).lines_for(run_of(1, 1002)), InputError);
}

/// Adding a run reads the lines of others, but parses none of them: what is damaged there is left
/// to those who show it. Showing parses the newest only.
TEST(History, WorkDoesNotGrowWithWhatIsNotShown) {
  std::string text;
  const std::vector<PastRun> runs = runs_of({1000, 1001, 1002, 1003});
  for (const PastRun& run : runs) text += History("h", text).lines_for(run);
  const std::size_t values = text.find("\"values\":[");
  ASSERT_NE(values, std::string::npos);
  text[values + 10] = '?';  // of the oldest run
  const History history("h", text);
  EXPECT_NE(history.lines_for(run_of(9, 1009)), "");
  EXPECT_EQ(history.like(runs[3].record, "", 3).size(), 3u);
  EXPECT_THROW((void)history.like(runs[3].record, "", 4), InputError);
}

/// Of ten thousand runs that change nothing the page holds the newest; of changes all.
TEST(HistoryPage, StaysSmall) {
  std::vector<double> cycles(10'000, 1000);
  for (std::size_t i = 5000; i < cycles.size(); ++i) cycles[i] = 1030;
  const std::vector<PastRun> runs = runs_of(cycles);
  const Budget budget = budget_of(kLimit);
  const std::string page = html_page(history_page("trend", runs, &budget));
  EXPECT_LT(page.size(), 2'000'000u);
  EXPECT_NE(page.find("commit 5000"), std::string::npos);
  EXPECT_EQ(page.find("commit 4999"), std::string::npos);
  std::vector<double> all;
  for (int i = 0; i < 10'000; ++i) all.push_back(1000 + i);
  EXPECT_LT(html_page(history_page("trend", runs_of(all), &budget)).size(), 2'000'000u);
}

}  // namespace
}  // namespace leviosim::tools
