// Figures that are easily taken one for the other: percentiles, longest calls and sums.
#include <gtest/gtest.h>

#include <set>
#include <string_view>

#include "platform_models/loader/loader.h"
#include "sim/soc/run_account.h"
#include "sim/work/op.h"
#include "tests/tools/example_run.h"
#include "tests/tools/statistic_values.h"
#include "tools/app/record/statistics.h"
#include "tools/app/report/tables.h"
#include "tools/app/result/camera_figures.h"
#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

using testing::value;

/// 200 frames in a closed loop, with latencies of 200, 199 … 1 µs.
RunResult long_loop() {
  RunResult run = testing::example_run();
  run.camera = CameraRecord{20, Deadline::Drop, {}};
  run.frames.clear();
  for (int i = 0; i < 200; ++i) {
    run.frames.push_back(testing::frame(i, PoseSource::Epnp, false, 1'000 * (200 - i)));
    run.camera->deliveries.push_back({i, 0, 50'000'000 * std::int64_t{i}, 0, false});
  }
  return run;
}

TEST(RunFigures, EveryPercentileOfLatencyIsItsOwn) {
  const RunFigures document = figures_of(long_loop());
  EXPECT_EQ(value(document, "frame.latency.p50"), 100'000);
  EXPECT_EQ(value(document, "frame.latency.p95"), 190'000);
  EXPECT_EQ(value(document, "frame.latency.p99"), 198'000);
  EXPECT_EQ(value(document, "frame.latency.worst"), 200'000);
}

TEST(FigureRows, DifferAndSayWhatTheyCompute) {
  const RunResult run = testing::example_run();
  const RunFigures document = figures_of(run);
  std::set<std::string_view> statistics_of_rows, phrases, titles;
  int computed = 0;
  for (const FigureRow& row : figure_rows()) {
    EXPECT_TRUE(statistics_of_rows.insert(row.statistic).second) << row.statistic;
    EXPECT_TRUE(row.phrase.empty() || phrases.insert(row.phrase).second) << row.phrase;
    EXPECT_TRUE(row.title.empty() || titles.insert(row.title).second) << row.title;
    EXPECT_EQ(row.title.empty(), row.title_unit.empty()) << row.statistic;
    if (row.of == nullptr) continue;
    ++computed;
    EXPECT_FALSE(row.title.empty() || row.meaning.empty()) << row.statistic;
    const double of = row.of(run).value();
    EXPECT_NEAR(value(document, std::string(row.statistic)).value(), of, 1e-6 * of);
  }
  EXPECT_GT(computed, 0);
}

TEST(RunFigures, AnOpenLoopHasPercentilesOfLatencyToo) {
  RunResult open = long_loop();
  open.camera.reset();
  const RunFigures document = figures_of(open);
  EXPECT_EQ(value(document, "frame.latency.p95"), 190'000);
  EXPECT_EQ(value(document, "frame.latency.worst"), 200'000);
}

TEST(RunFigures, ALatencyOfExactlyThePeriodIsInTime) {
  RunResult run = testing::example_run();
  EXPECT_FALSE(is_late(testing::frame(0, PoseSource::Epnp, false, run.frame_period_ns), run));
  EXPECT_TRUE(is_late(testing::frame(0, PoseSource::Epnp, false, run.frame_period_ns + 1), run));
  run.frames = {testing::frame(0, PoseSource::Epnp, false, run.frame_period_ns)};
  EXPECT_EQ(value(figures_of(run), "latency.epnp.over_period"), 0);
}

TEST(RunFigures, TheWorstIsTheLongestOfSeveralAndNoSum) {
  const RunFigures document = figures_of(testing::example_run());
  EXPECT_EQ(value(document, "stages.feature_extraction.cycles.parallel.sum"), 2'000'000);
  EXPECT_EQ(value(document, "stages.feature_extraction.cycles.parallel.worst"), 1'200'000);
  EXPECT_EQ(value(document, "latency.epnp.worst"), 40'000'000);  // of two frames: 30 and 40 ms
}

TEST(RunFigures, TheBookKeepsTheLongestCallOfAStage) {
  soc::RunAccount book({}, platform::load_platform("gap9"));
  for (const int cycles : {300, 500, 200}) {
    sim::StageTiming stage{"matching", {}, {}, Cycles(cycles), {}};
    stage.account.team[sim::Mechanism::Serial] = cycles;
    book.add_parallel({{}, {}, {stage}});
    stage.cycles = Cycles(10 * cycles);
    book.add_single({{}, {}, {stage}});
  }
  ASSERT_EQ(book.stages().size(), 1u);
  const StageResult& stage = book.stages().front();
  EXPECT_EQ(stage.parallel, Cycles(1000));
  EXPECT_EQ(stage.worst_parallel, Cycles(500));
  EXPECT_EQ(stage.single, Cycles(10000));
  EXPECT_EQ(stage.account.team[sim::Mechanism::Serial], 1000);
}

TEST(RunFigures, TheBookSaysWhatRestsOnCodeThatWasNotMeasured) {
  const sim::ChipConfig chip = platform::load_platform("gap9");
  soc::RunAccount book({}, chip);
  work::Segment measured, unmeasured;
  measured[work::Op::IntAlu] = unmeasured[work::Op::IntAlu] = 1000;
  work::CompiledWork compiled{};
  compiled[static_cast<std::size_t>(work::Compiled::Executed)] = 900;
  compiled[static_cast<std::size_t>(work::Compiled::Priced)] = 900;
  work::set_compiled(measured.compiled, chip.cluster.core.code, compiled);
  const work::Fork fork{"share", {measured, unmeasured}};
  book.add_work({{{"matching", {work::Serial{measured}, fork, work::Serial{unmeasured}}, {}}}});
  StageResult stage = book.stages().front();
  const double cycles = 1000 * chip.cluster.core.unmeasured_instructions;
  EXPECT_DOUBLE_EQ(stage.unmeasured, 2 * cycles);
  stage.single = Cycles(static_cast<std::int64_t>(4 * cycles));
  EXPECT_NEAR(*unmeasured_share(stage), 0.5, 1e-3);
  stage.single = Cycles(1);
  EXPECT_EQ(unmeasured_share(stage), 1.0);
  stage.single = Cycles(0);
  EXPECT_EQ(unmeasured_share(stage), std::nullopt);
}

TEST(RunFigures, TheStageTableNamesStagesThatWereNotMeasured) {
  RunResult run = testing::example_run();
  EXPECT_EQ(stage_table(run, 200).find("not measured"), std::string::npos);
  StageResult& stage = run.stages.front();
  stage.unmeasured = 0.25 * static_cast<double>(stage.single.count());
  EXPECT_NE(stage_table(run, 200).find("unmeasured_instructions): 25 % of " + stage.name),
            std::string::npos);
  stage.unmeasured = 0.002 * static_cast<double>(stage.single.count());
  EXPECT_EQ(stage_table(run, 200).find("not measured"), std::string::npos);
}

TEST(RunFigures, TheBookAddsUpTransfers) {
  soc::RunAccount book({}, platform::load_platform("gap9"));
  const work::Transfer in{work::Direction::L2ToL1, Bytes(100)};
  const work::Transfer far{work::Direction::ExternalToL2, Bytes(7)};
  for (int k = 0; k < 3; ++k) book.add_work({{{"matching", {in, far, in}, {}}}});
  ASSERT_EQ(book.stages().size(), 1u);
  const StageResult& stage = book.stages().front();
  EXPECT_EQ(stage.calls, 3);
  EXPECT_EQ(stage.transfers.transfers, 6);
  EXPECT_EQ(stage.transfers.bytes, Bytes(600));
  EXPECT_EQ(stage.transfers.external, Bytes(21));
}

}  // namespace
}  // namespace leviosim::tools
