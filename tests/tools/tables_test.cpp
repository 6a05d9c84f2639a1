#include "tools/app/report/tables.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <sstream>

#include "tests/support/text_lines.h"
#include "tests/tools/example_run.h"
#include "tools/app/report/run_summary.h"
#include "tools/app/result/summary.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

using testing::example_run;
using tests::lines_of;

/// The one line that begins with `start`; empty if there is none.
std::string line_of(const std::string& text, const std::string& start) {
  for (const std::string& line : lines_of(text))
    if (line.rfind(start, 0) == 0) return line;
  return {};
}

/// The words of a line after its first `skipped` characters.
std::vector<std::string> cells_after(const std::string& line, std::size_t skipped) {
  std::istringstream in(line.substr(skipped));
  std::vector<std::string> cells;
  for (std::string cell; in >> cell;) cells.push_back(cell);
  return cells;
}

using Cells = std::vector<std::string>;

TEST(TerminalTable, AlignsByCodePointsAndTrimsLineEnds) {
  Table table({{"a", kLeft}, {"n"}, {"t", kLeft}});
  table.add({"é–×", "1", "x"});
  table.add({"b", "1000", ""});
  EXPECT_EQ(terminal_text(table),
            "a       n  t\n"
            "────────────\n"
            "é–×     1  x\n"
            "b    1000\n");
}

TEST(TerminalTable, LeavesOutColumnsThatDoNotFit) {
  Table table({{"name", kLeft}, {"a", kRight, 1}, {"b"}, {"c", kRight, 1}});
  table.add({"x", "100", "200", "300"});
  const auto titles = [&](int width) {
    std::istringstream in(terminal_text(table, width));
    std::string line;
    std::getline(in, line);
    return line;
  };
  EXPECT_EQ(terminal_text(table, 19), terminal_text(table));
  EXPECT_EQ(titles(19), "name    a    b    c");
  EXPECT_EQ(titles(18), "name    a    b …");
  EXPECT_EQ(titles(15), "name    b …");
  EXPECT_EQ(titles(8), "name …");
  EXPECT_EQ(titles(5), "na… …") << "the first column stays";
  EXPECT_EQ(titles(1), "… …");
  EXPECT_EQ(terminal_text(table, 13),
            "name    b …\n"
            "─────────\n"
            "x     200\n");
}

TEST(TerminalTable, CutsLongTextBeforeItLeavesOutColumns) {
  const std::string text = "a text of thirty-two characters.";
  Table table({{"name", kLeft}, {"a"}, {"text", kLeft}});
  table.add({"x", "100", text});
  EXPECT_EQ(terminal_text(table, 43), terminal_text(table));
  EXPECT_EQ(terminal_text(table, 42),
            "name    a  text\n"
            "──────────────────────────────────────────\n"
            "x     100  a text of thirty-two character…\n");
  const std::string least = terminal_text(table, 31);
  EXPECT_NE(least.find("x     100  a text of thirty-tw…\n"), std::string::npos) << least;
  EXPECT_EQ(terminal_text(table, 30),
            "name    a …\n"
            "─────────\n"
            "x     100\n");
}

TEST(TerminalTable, CutsNamesOfRowsToHalfOfTheWidthOnly) {
  Table table({{"text", kLeft}, {"a"}});
  table.add({"a text of thirty-two characters.", "100"});
  EXPECT_EQ(terminal_text(table, 29),
            "text                        a\n"
            "─────────────────────────────\n"
            "a text of thirty-two ch…  100\n");
  EXPECT_EQ(terminal_text(table, 24),
            "text …\n"
            "────────────────────\n"
            "a text of thirty-tw…\n");
}

TEST(TerminalTable, HasTheWidthOfTheProgramWhereNoneIsAskedFor) {
  Table table({{"name", kLeft}, {"a"}});
  table.add({"x", "100"});
  const std::string whole = terminal_text(table, kAnyWidth);
  EXPECT_EQ(terminal_text(table), whole);
  set_table_width(8);
  const std::string narrow = terminal_text(table);
  set_table_width(kAnyWidth);
  EXPECT_EQ(narrow, terminal_text(table, 8));
  EXPECT_NE(narrow, whole);
}

TEST(TerminalTable, ShowsNumbersInTheUnitOfTheirColumn) {
  Table table({{"name", kLeft},
               {.title = "ms", .shown = 2, .scale = 1e-6},
               {.title = "mW", .shown = 1, .nothing = "unknown"},
               {.key = "only_in_files"}});
  table.add({"a", 1'234'567, Banded{2, 1.5, 2.5}, 1});
  table.add({"b", Cell(), Cell(), 1});
  EXPECT_EQ(terminal_text(table),
            "name    ms             mW\n"
            "─────────────────────────\n"
            "a     1.23  2.0 (1.5–2.5)\n"
            "b        –        unknown\n");
}

TEST(TerminalTable, SaysThatAPathDivergedWhereNoVehicleFliesSoFar) {
  Table table({{.title = "error", .shown = 2, .key = "ate_m"},
               {.title = "path", .unit = "m", .scale = 1e-3},
               {.title = "count", .key = "count"}});
  table.add({2.54e23, 3e12, 2.54e23});
  table.add({0.5, 1500.0, 7.0});
  EXPECT_EQ(shown_cells(table)[1], (std::vector<std::string>{"diverged", "diverged", "2.54e+23"}));
  EXPECT_EQ(shown_cells(table)[2], (std::vector<std::string>{"0.50", "1.5", "7"}));
}

TEST(Tables, FitTheWidth) {
  const RunResult run = example_run();
  const auto header = [](const std::string& table) { return lines_of(table).at(1); };
  for (const std::string& table : {stage_table(run, 80), breakdown_table(run, 80),
                                   latency_table(run, 80), memory_table(run, 80)})
    EXPECT_LE(display_width(header(table)), 80) << table;
  EXPECT_NE(header(stage_table(run, 80)).find("speed-up"), std::string::npos);
  EXPECT_EQ(header(stage_table(run, 80)).find("calls"), std::string::npos);
  EXPECT_NE(header(breakdown_table(run, 80)).find("serial"), std::string::npos);
  EXPECT_EQ(header(breakdown_table(run, 80)).find("core-Mcycles"), std::string::npos);
}

TEST(TerminalTable, WrapsListsWhereTheyWouldExceedTheWidth) {
  EXPECT_EQ(wrap({"aaaa", "bbbb", "cccc"}, " · ", 2, 13), "aaaa · bbbb\n  cccc");
  EXPECT_EQ(wrap({"aaaa", "bbbb"}, " · ", 2, 12), "aaaa\n  bbbb");
  EXPECT_EQ(wrap({}, " · ", 2, 12), "");
}

TEST(StageTable, ShowsMeansOfACallSpeedUpAndTime) {
  const std::string line = line_of(stage_table(example_run()), "feature extraction");
  // 8 Mcycles in 2 calls, 1000 kcycles at 100 MHz are 10 ms, the worst call has 1200 kcycles.
  EXPECT_EQ(cells_after(line, 18),
            (Cells{"frame", "2", "4000.00", "1000.00", "4.00", "10.000", "12.000"}));
}

TEST(StageTable, TimesTheControllerByItsOwnClock) {
  const std::string text = stage_table(example_run());
  const std::string line = line_of(text, "optimiser iteration ¹");
  EXPECT_EQ(cells_after(line, std::string("optimiser iteration ¹").size()),
            (Cells{"iteration", "3", "500.00", "500.00", "1.00", "10.000", "12.000"}));
  EXPECT_NE(text.find("¹ on the fabric controller"), std::string::npos);
}

TEST(StageTable, SaysWhichProgramOneCoreRuns) {
  RunResult run = example_run();
  const std::string note = "1 core: this program on the master alone (--cores 1:";
  EXPECT_NE(stage_table(run).find(note), std::string::npos);
  run.cores = 1;
  EXPECT_EQ(stage_table(run).find(note), std::string::npos);
}

TEST(StageTable, ShowsDashesForAStageWithoutCalls) {
  const std::string line = line_of(stage_table(example_run()), "EPnP RANSAC");
  EXPECT_EQ(cells_after(line, 11), (Cells{"frame", "0", "–", "–", "–", "–", "–"}));
}

TEST(BreakdownTable, SharesAddUpTo100PerCent) {
  const std::string text = breakdown_table(example_run());
  const Cells cells = cells_after(line_of(text, "feature extraction"), 18);
  // 5 of 8 Mcycles are useful, 1 waits for a floating-point unit; rounding counts as imbalance.
  // Three tenths are handed out: to serial (99.875), imbalance (37.625) and divider (62.5).
  EXPECT_EQ(cells,
            (Cells{"62.5", "0.0", "12.5", "6.3", "1.2", "3.8", "1.2", "2.5", "10.0", "8.0"}));
  double sum = 0;
  for (std::size_t i = 0; i + 1 < cells.size(); ++i) sum += std::stod(cells[i]);
  EXPECT_NEAR(sum, 100.0, 1e-9);
}

TEST(BreakdownTable, LeavesOutTheControllerAndShowsDashesWithoutCalls) {
  const std::string text = breakdown_table(example_run());
  EXPECT_EQ(text.find("optimiser iteration"), std::string::npos);
  const Cells cells = cells_after(line_of(text, "EPnP RANSAC"), 11);
  EXPECT_EQ(cells, Cells(10, "–"));
}

TEST(BreakdownTable, TenthsAddUpForAnyParts) {
  for (const std::vector<double>& parts :
       {std::vector<double>{1, 1, 1}, {1, 2, 4, 8, 16, 32, 1e-9}, {0.3333, 0.6667, 0, 12345.678}}) {
    const std::vector<double> tenths = tenths_of_percent(parts);
    const double total = std::accumulate(parts.begin(), parts.end(), 0.0);
    EXPECT_NEAR(std::accumulate(tenths.begin(), tenths.end(), 0.0), 100.0, 1e-9);
    for (std::size_t i = 0; i < parts.size(); ++i)
      EXPECT_LE(std::abs(tenths[i] - 100 * parts[i] / total), 0.1);
  }
  EXPECT_EQ(tenths_of_percent({0, 0}), (std::vector<double>{0, 0}));
}

TEST(BreakdownTable, PartsAreTheWholeBreakdown) {
  const sim::MechanismCycles breakdown = example_run().stages[0].account.team;
  double sum = 0;
  for (const sim::MechanismInfo& part : breakdown_parts(example_run()))
    sum += breakdown[part.mechanism];
  EXPECT_DOUBLE_EQ(sum, breakdown.total());
  EXPECT_DOUBLE_EQ(breakdown.total(), 8e6);
}

TEST(LatencyTable, TellsTheKindsOfFrameApart) {
  const std::string text = latency_table(example_run());
  const auto row = [&](const std::string& name) {
    return cells_after(line_of(text, name + "  "), name.size());
  };
  EXPECT_EQ(row("EPnP"), (Cells{"2", "35.00", "40.00", "70.0", "80.0", "0"}));
  EXPECT_EQ(row("EPnP, keyframe"), (Cells{"0", "–", "–", "–", "–", "0"}));
  EXPECT_EQ(row("8-point"), (Cells{"1", "20.00", "20.00", "40.0", "40.0", "0"}));
  EXPECT_EQ(row("8-point, keyframe"), (Cells{"1", "60.00", "60.00", "120.0", "120.0", "1"}));
  EXPECT_EQ(row("other (first, initialising, pose kept)"),
            (Cells{"1", "10.00", "10.00", "20.0", "20.0", "0"}));
  EXPECT_NE(text.find("frame period 50.00 ms"), std::string::npos);
  EXPECT_NE(text.find("waited for the front end: 1, the longest 2.50 ms"), std::string::npos);
}

TEST(LatencyTable, PredictedFramesAreAKindOfTheirOwn) {
  RunResult run = example_run();
  EXPECT_EQ(latency_table(run).find("predicted"), std::string::npos);
  run.frames[4].source = PoseSource::Predicted;
  const std::string text = latency_table(run);
  EXPECT_EQ(cells_after(line_of(text, "EPnP  "), 4),
            (Cells{"1", "30.00", "30.00", "60.0", "60.0", "0"}));
  EXPECT_EQ(cells_after(line_of(text, "predicted  "), 9),
            (Cells{"1", "40.00", "40.00", "80.0", "80.0", "0"}));
  EXPECT_EQ(line_of(text, "tracked"), "");
  run.frames[3].source = PoseSource::Tracked;
  const std::string both = latency_table(run);
  EXPECT_EQ(cells_after(line_of(both, "tracked  "), 7).front(), "1");
  EXPECT_EQ(cells_after(line_of(both, "predicted  "), 9).front(), "1");
  EXPECT_EQ(cells_after(line_of(both, "other (first, initialising, pose kept)"), 38).front(), "1");
}

/// Every source is named, and the restarts of the map are.
TEST(FrameSummary, AddsUp) {
  RunResult run = example_run();
  run.frames.clear();
  for (int k = 0; k <= static_cast<int>(PoseSource::Tracked); ++k)
    for (int i = 0; i <= k; ++i)
      run.frames.push_back(testing::frame(k, static_cast<PoseSource>(k), false, 10'000'000));
  run.frames[0].map_restarts = run.frames[7].map_restarts = 1;
  const std::string line = line_of(frame_summary(run), "frames: ");
  EXPECT_EQ(line,
            "frames: 21 (tracked 6, EPnP 2, 8-point 3, predicted 5, pose kept 4, at rest or first "
            "of a map 1), "
            "keyframes 0, restarts of the map 2");
}

TEST(LatencyTable, EveryFrameIsInOneScenario) {
  const RunResult run = example_run();
  std::int64_t frames = 0;
  for (const Scenario& scenario : scenarios(run)) frames += scenario.frames;
  EXPECT_EQ(frames, static_cast<std::int64_t>(run.frames.size()));
}

TEST(MemoryTable, ShowsKilobytesAndSharesOfTheSize) {
  const std::string text = memory_table(example_run());
  EXPECT_EQ(cells_after(line_of(text, "feature extraction"), 18),
            (Cells{"L1", "32.0", "64.0", "24.41", "48.83"}));
  EXPECT_EQ(cells_after(line_of(text, "EPnP RANSAC"), 11), (Cells{"L1", "–", "–", "–", "–"}));
  EXPECT_EQ(cells_after(line_of(text, "last keyframe"), 13),
            (Cells{"L2", "50.9", "–", "3.11", "–"}));
  EXPECT_NE(text.find("% of 131.1 kB L1 and 1638.4 kB L2"), std::string::npos);
}

TEST(MemoryTable, NamesTheBlocksAliveAtThePeak) {
  const std::string text = memory_table(example_run());
  EXPECT_NE(text.find("feature extraction  image 19.2 · scratch ×2 20.0\n"), std::string::npos);
  EXPECT_NE(
      text.find("last keyframe       keypoints 2.8 · image 19.2 · below 0.1: count · flags\n"),
      std::string::npos);
}

TEST(MemoryTable, PeakOfTheControllerIsARowOfL2Only) {
  const std::string text = memory_table(example_run());
  EXPECT_EQ(text.find("optimiser iteration"), std::string::npos);
  EXPECT_FALSE(line_of(text, "optimiser").empty());
}

TEST(TrajectorySummary, GivesTheProtocolBesideTheError) {
  const std::string text = trajectory_summary(example_run());
  EXPECT_NE(text.find("5 poses, 2.00 m long"), std::string::npos);
  EXPECT_NE(text.find("0.176 m RMSE"), std::string::npos);
  EXPECT_NE(text.find(example_run().ate->protocol), std::string::npos);
}

/// Positions alone were aligned, so the angle after that alignment says nothing.
TEST(TrajectorySummary, GivesAttitudesAfterAnAlignmentOfTheirOwn) {
  RunResult run = example_run();
  EXPECT_EQ(trajectory_summary(run).find("°"), std::string::npos) << "a replay knows no poses";
  traces::Trajectory truth;
  for (const FrameResult& f : run.frames) truth.push_back(f.pose);
  truth[2].T_world_body.translation().y() = 1;
  const Eigen::AngleAxisd lying(1.5707963267948966, Eigen::Vector3d::UnitX());
  traces::Trajectory estimate = truth;
  for (traces::StampedPose& pose : estimate) pose.T_world_body = lying * pose.T_world_body;
  run.ate = traces::evaluate(estimate, truth);
  const std::string text = trajectory_summary(run);
  EXPECT_NE(text.find("attitude: tilt 0.00° RMSE, heading 0.00° RMSE, best aligned\n"
                      "     not gravity-aligned: its vertical is 90.0° off the true one\n"),
            std::string::npos)
      << text;
}

TEST(TrajectorySummary, SaysWhereThereIsNoGroundTruth) {
  RunResult run = example_run();
  run.ate.reset();
  EXPECT_NE(trajectory_summary(run).find("no ground truth"), std::string::npos);
}

TEST(TrajectorySummary, SaysWhatCannotBeCompared) {
  RunResult run = example_run();
  run.ate.reset();
  run.poses_left_out = 2;
  run.not_comparable = "the positions are too large";
  const std::string text = trajectory_summary(run);
  EXPECT_NE(text.find("2 more are NaN and are left out"), std::string::npos);
  EXPECT_NE(text.find("ATE: none: the positions are too large"), std::string::npos);
  EXPECT_EQ(text.find("no ground truth"), std::string::npos);
  run.not_comparable.clear();  // as in a replay, which evaluates nothing
  EXPECT_NE(trajectory_summary(run).find("ATE: none: 2 poses are NaN"), std::string::npos);
}

TEST(Report, OnlyItsLastLineIsAboutTheHost) {
  RunResult run = example_run();
  const std::vector<std::string> first = lines_of(report(run));
  run.host_seconds = 7;
  const std::vector<std::string> second = lines_of(report(run));
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i + 1 < first.size(); ++i) EXPECT_EQ(first[i], second[i]);
  EXPECT_EQ(first.back(), "host: 5 frames in 2.5 s (2.0 frames/s, 0.1 times real time)");
}

TEST(Report, TablesAreChosenByName) {
  const RunResult run = example_run();
  const std::string latency = report(run, {"latency"});
  EXPECT_NE(latency.find("pose from"), std::string::npos);
  EXPECT_EQ(latency.find("kcycles"), std::string::npos);
  EXPECT_EQ(report(run, table_names()), report(run));
  const std::string two = report(run, {"memory", "stages"});
  EXPECT_LT(two.find("kcycles"), two.find("blocks alive"));
}

TEST(Report, OfANativeRunHasNoTiming) {
  RunResult run = example_run();
  run.timed = false;
  const std::string text = report(run);
  EXPECT_EQ(text.find("kcycles"), std::string::npos);
  EXPECT_EQ(text.find("L1"), std::string::npos);
  EXPECT_NE(text.find("trajectory: 5 poses"), std::string::npos);
}

TEST(Report, OfAnEmptyRunIsStillText) {
  const RunResult run;
  EXPECT_NE(report(run).find("frames: 0"), std::string::npos);
}

}  // namespace
}  // namespace leviosim::tools
