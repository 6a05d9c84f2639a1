// Steps and drift of figures over runs.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <thread>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "tests/support/scratch.h"
#include "tools/app/history/history.h"
#include "tools/app/history/history_report.h"
#include "tools/app/history/trends.h"
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

History history_of(const std::string& text) { return {"h", base::Pieces(text)}; }

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
    EXPECT_EQ(trend.drift.size(), std::pow(1.002, n) > 1.01 ? static_cast<std::size_t>(n) : 0u)
        << n;
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
  for (const PastRun& run : runs) text += history_of(text).line_for(run);
  const History history = history_of(text);
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
  for (const PastRun& run : runs_of({1000, 1001})) text += history_of(text).line_for(run);
  EXPECT_EQ(history_of(text + text).size(), 2u);
  EXPECT_EQ(history_of(text).line_for(run_of(1, 1001)), "");
  EXPECT_THROW((void)history_of(text).line_for(run_of(1, 1002)), InputError);
}

/// The lines of all but the newest runs, each with a value that cannot be parsed.
std::string damaged(std::string text, std::size_t whole) {
  std::vector<std::size_t> values;
  for (std::size_t at = text.find("\"stages\":["); at != std::string::npos;
       at = text.find("\"stages\":[", at + 1))
    values.push_back(at);
  for (std::size_t i = 0; i + whole < values.size(); ++i) text[values[i] + 10] = '?';
  return text;
}

/// Adding a run reads the lines of others, but parses none of them: what is damaged there is left
/// to those who show it. Showing parses the newest only, and of other profiles one.
TEST(History, WorkDoesNotGrowWithWhatIsNotShown) {
  std::string text;
  for (const PastRun& run : runs_of({1000, 1001})) text += history_of(text).line_for(run);
  PastRun other = run_of(0, 1000);
  other.record.facts.profile = "next";
  std::string others = history_of(text).line_for(other);
  const std::size_t begin = text.rfind("{\"run\"");
  const std::string line = text.substr(begin);
  for (int n = 2; n < 10'000; ++n) {
    std::string next = line;
    next.replace(next.find("c000"), 40, fmt::format("c{:039}", n));
    next.replace(next.find(":1001,"), 6, fmt::format(":{},", 1000 + n));
    text += next;
  }
  const History history = history_of(damaged(text, 3));
  ASSERT_EQ(history.size(), 10'000u);
  EXPECT_NE(history.line_for(run_of(20'000, 1009)), "");
  EXPECT_EQ(history.line_for(run_of(9998, 1001)), "") << "is there";
  const RunRecord run = run_of(1, 1001).record;
  EXPECT_EQ(history.lines_parsed(), 0u);
  EXPECT_EQ(history.like(run, "", 3).size(), 3u);
  EXPECT_EQ(history.lines_parsed(), 3u);
  EXPECT_THROW((void)history.like(run, "", 4), InputError);

  // One of another profile before them all: only the newest of those is parsed on the way to it.
  const std::size_t of_other = others.rfind("{\"run\"");
  const History mixed =
      history_of(damaged(others.substr(of_other) + text, 1) + others.substr(0, of_other));
  EXPECT_THROW((void)mixed.like(other.record, "", 1), InputError) << "itself is damaged";
  const History behind = history_of(others + damaged(text, 0));
  EXPECT_EQ(behind.like(other.record, "", 1).size(), 1u) << "of others, none is parsed";
}

/// Of a file a piece is held at a time. It is read once by who adds to it; by who shows the newest
/// runs, their lines again.
TEST(History, IsReadInPiecesAndOnce) {
  const tests::Scratch folder;
  const std::string file = (folder / "h.jsonl").string();
  std::vector<double> cycles(3000);
  for (std::size_t i = 0; i < cycles.size(); ++i) cycles[i] = 1000.0 + static_cast<double>(i);
  const std::vector<PastRun> runs = runs_of(cycles);
  std::string text;
  for (const PastRun& run : runs) text += history_of("").line_for(run);
  tests::write_text(file, text);
  const History history = History::read(file);
  ASSERT_EQ(history.size(), 3000u);
  EXPECT_NE(history.line_for(run_of(3000, 1)), "");
  EXPECT_LT(history.bytes_read(), text.size() + text.size() / 50) << "lines that two pieces share";
  EXPECT_EQ(history.like(runs[0].record, "", 200).size(), 200u);
  EXPECT_LT(history.bytes_read(), 2 * text.size());
  const History whole = history_of(text);
  for (const std::size_t i : {0, 1, 1499, 2998, 2999})
    EXPECT_EQ(history.line_for(history.run(i)), whole.line_for(whole.run(i))) << i;
  for (const PastRun& run : history.like(runs[0].record, "", 3000))
    EXPECT_EQ(history.line_for(run), "") << run.origin.commit;
}

void add_run(const std::string& file, const PastRun& run) {
  add_to_history(file, [&](const History& history) { return history.line_for(run); });
}

/// What is added stands behind what was there, of which no byte changes; and so it is where a
/// program was stopped in the middle of a line.
TEST(History, IsAddedToAllOrNothing) {
  const tests::Scratch folder;
  const std::string file = (folder / "h.jsonl").string();
  std::vector<std::string> texts{""};
  for (const PastRun& run : runs_of({1000, 1001, 1002})) {
    add_run(file, run);
    texts.push_back(tests::read_text(file));
    EXPECT_TRUE(texts.back().starts_with(texts[texts.size() - 2]));
  }
  for (std::size_t size = texts[2].size() + 1; size < texts[3].size(); ++size) {
    tests::write_text(file, texts[3].substr(0, size));
    const bool lacks_a_break_only = size + 1 == texts[3].size();
    EXPECT_EQ(History::read(file).size(), lacks_a_break_only ? 3u : 2u) << size;
    add_run(file, run_of(2, 1002));
    if (lacks_a_break_only) continue;  // it is there already
    EXPECT_EQ(tests::read_text(file), texts[3]) << size;
  }
  // A whole line without a break, as editors leave it, is not glued to the next.
  tests::write_text(file, texts[2].substr(0, texts[2].size() - 1));
  add_run(file, run_of(2, 1002));
  EXPECT_EQ(tests::read_text(file), texts[3]);
  // What is no history at all stays as it is.
  tests::write_text(file, "a letter");
  EXPECT_THROW(add_run(file, run_of(2, 1002)), InputError);
  EXPECT_EQ(tests::read_text(file), "a letter");
  EXPECT_THROW(add_run(folder.path().string(), run_of(2, 1002)), InputError);
}

/// The first runs of a history, by jobs that end together.
TEST(History, IsBegunByManyAtOnce) {
  const tests::Scratch folder;
  for (int round = 0; round < 10; ++round) {
    const std::string file = (folder / fmt::format("{}.jsonl", round)).string();
    std::vector<std::thread> jobs;
    for (int n = 0; n < 4; ++n)
      jobs.emplace_back([=] {
        EXPECT_NO_THROW({
          add_to_history(file, [&](const History& history) {
            return n > 0 ? history.line_for(run_of(n, 1000)) : std::string();
          });
        });
      });
    for (std::thread& job : jobs) job.join();
    EXPECT_EQ(History::read(file).size(), 3u);
  }
  const std::string none = (folder / "none.jsonl").string();
  add_to_history(none, [](const History&) { return std::string(); });
  EXPECT_FALSE(base::exists(none)) << "nothing was added";
}

/// Runs of one second, such as a script adds without git, are told apart as quickly.
TEST(History, RunsOfOneTimeKeepTheirOrder) {
  std::string text;
  for (int n = 0; n < 3; ++n) {
    PastRun run = run_of(n, 1000 + n);
    run.origin.time_s = 5;
    text += history_of(text).line_for(run);
  }
  const History history = history_of(text + text);
  ASSERT_EQ(history.size(), 3u);
  for (int n = 0; n < 3; ++n)
    EXPECT_EQ(history.origin(static_cast<std::size_t>(n)).commit, fmt::format("c{:039}", n));
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
