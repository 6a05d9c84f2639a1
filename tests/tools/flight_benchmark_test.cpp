// Benchmarks of flights: how runs are condensed.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tools/app/study/flights/benchmark.h"
#include "tools/app/study/flights/benchmark_tables.h"
#include "tools/app/study/flights/flight_plan.h"
#include "tools/app/study/flights/piece_figures.h"
#include "tools/app/table/table_files.h"
#include "tools/app/table/terminal_table.h"
#include "traces/datasets/rng.h"

namespace leviosim::tools {
namespace {

TEST(MedianInterval, HasTheOrderStatisticsOfATable) {
  // Ranks and confidences for a confidence of 95 % as in tables of the binomial distribution.
  struct Row {
    std::size_t values, from_end;
    double confidence;
  };
  for (const Row& row : {Row{2, 1, 0.5},
                         {3, 1, 0.75},
                         {5, 1, 0.9375},
                         {6, 1, 0.96875},
                         {8, 1, 0.9921875},
                         {9, 2, 0.9609375},
                         {12, 3, 0.9614258},
                         {24, 7, 1 - 2 * 190051 / 16777216.0}}) {
    std::vector<std::optional<double>> values;
    for (std::size_t i = row.values; i > 0; --i) values.emplace_back(static_cast<double>(i));
    const MedianInterval interval = median_interval(values);
    EXPECT_EQ(interval.values, row.values);
    EXPECT_EQ(interval.low, static_cast<double>(row.from_end)) << row.values;
    EXPECT_EQ(interval.high, static_cast<double>(row.values + 1 - row.from_end)) << row.values;
    EXPECT_NEAR(interval.confidence, row.confidence, 1e-7) << row.values;
  }
}

TEST(MedianInterval, NeedsTwoValuesAndTakesFailuresAsInfinite) {
  for (const std::size_t count : {0u, 1u}) {
    const MedianInterval none =
        median_interval(std::vector<std::optional<double>>(count, std::optional(1.0)));
    EXPECT_EQ(none.confidence, 0);
    EXPECT_FALSE(none.low);
    EXPECT_FALSE(none.high);
  }
  const MedianInterval failed = median_interval({1.0, std::nullopt, 2.0});
  EXPECT_EQ(failed.low, 1.0);
  EXPECT_FALSE(failed.high);
}

/// Also where 2^-n is no number any more.
TEST(MedianInterval, OfManyValuesIsThatOfTheNormalDistribution) {
  constexpr int kCount = 10'000;
  std::vector<std::optional<double>> values;
  for (int i = 1; i <= kCount; ++i) values.emplace_back(i);
  const MedianInterval interval = median_interval(values);
  EXPECT_GE(interval.confidence, 0.95);
  EXPECT_LT(interval.confidence, 0.952);
  EXPECT_NEAR(interval.low.value(), 0.5 * kCount - 1.96 * 0.5 * std::sqrt(kCount), 1.5);
}

TEST(MedianInterval, CoversTheTrueMedianAsOftenAsItSays) {
  traces::Rng rng(1);
  constexpr int kSamples = 20'000;
  for (const std::size_t count : {3u, 9u, 15u}) {
    int covered = 0;
    double confidence = 0;
    for (int s = 0; s < kSamples; ++s) {
      std::vector<std::optional<double>> values;
      for (std::size_t i = 0; i < count; ++i) values.emplace_back(std::exp(5 * rng.uniform()));
      const MedianInterval interval = median_interval(values);
      covered += *interval.low <= std::exp(2.5) && std::exp(2.5) <= *interval.high;
      confidence = interval.confidence;
    }
    const double deviation = std::sqrt(confidence * (1 - confidence) / kSamples);
    EXPECT_NEAR(static_cast<double>(covered) / kSamples, confidence, 4 * deviation) << count;
  }
}

/// Two motions, one world per set, two pieces each, seeds 1 to 3.
class FlightBenchmark : public ::testing::Test {
 protected:
  FlightBenchmark() {
    benchmark_.plan = parse_flight_plan(
        "p.yaml", "motions: [a, b]\nworlds: { development: [1], fresh: [2] }\npieces: [90]\n");
    benchmark_.plan.name = "example";
    benchmark_.motions.resize(2);
    for (std::size_t m = 0; m < 2; ++m) {
      benchmark_.motions[m].sequence.name = benchmark_.plan.motions[m];
      benchmark_.motions[m].sequence.inputs = "digest of " + benchmark_.plan.motions[m];
    }
    benchmark_.motions[0].starts.at_rest = 2;
    benchmark_.too_late = 3;
    for (const std::size_t set : {0u, 1u})
      for (const std::size_t motion : {0u, 1u})
        for (const std::size_t start : {400u, 800u}) {
          FlightPiece piece;
          piece.motion = motion;
          piece.set = set;
          piece.world.seed = set + 1;
          piece.length = 90;
          piece.frames = {start, start + 90};
          benchmark_.pieces.push_back(piece);
        }
    runs_ = benchmark_runs(benchmark_);
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      RunOutcome& outcome = outcomes_.emplace_back();
      outcome.ate_m = 0.01 * static_cast<double>(i + 1);
      outcome.path_m = i < 12 ? 2 : 4;
      outcome.scale = {1, 0.9, std::nullopt};
      outcome.map_restarts = 1;
      if (i > 0) outcome.end_drift_m = 0.1 * static_cast<double>(i);
    }
  }
  BenchmarkResult result() const { return condense(benchmark_, runs_, outcomes_); }

  Benchmark benchmark_;
  std::vector<Point> runs_;
  std::vector<RunOutcome> outcomes_;
};

TEST_F(FlightBenchmark, HasARunForEachPieceAndSeed) {
  ASSERT_EQ(runs_.size(), 8u * 3);
  std::set<std::string> keys;
  const platform::Schema schema;
  for (const Point& run : runs_) keys.insert(run_key(run, {}, schema));
  EXPECT_EQ(keys.size(), runs_.size());
  EXPECT_EQ(runs_[5].request.seed, 3u);
  EXPECT_EQ(runs_[5].row, row_of(benchmark_, 0, 1));
  EXPECT_TRUE(runs_[5].request.native);
}

TEST_F(FlightBenchmark, APieceCountsOnceWithTheMedianOfItsSeeds) {
  const BenchmarkResult all = result();
  ASSERT_EQ(all.rows.size(), 2u * 3) << "two motions and all of them, in two sets";
  const BenchmarkRow& row = all.rows[0];  // development, a: runs 0 to 5 with 0.01 to 0.06 m
  EXPECT_EQ(row.motion, 0u);
  EXPECT_EQ(row.pieces, 2u);
  EXPECT_EQ(row.runs, 6u);
  EXPECT_NEAR(row.metres.median.value(), (0.02 + 0.05) / 2, 1e-12);
  EXPECT_NEAR(row.percent.median.value(), 100 * (0.02 + 0.05) / 2 / 2, 1e-9);
  EXPECT_NEAR(row.metres.over_pieces.low.value(), 0.02, 1e-12);
  EXPECT_NEAR(row.metres.over_pieces.high.value(), 0.05, 1e-12);
  EXPECT_EQ(row.metres.over_pieces.confidence, 0.5);
  EXPECT_NEAR(row.metres.over_seeds.low.value(), (0.01 + 0.04) / 2, 1e-12);
  EXPECT_NEAR(row.metres.over_seeds.high.value(), (0.03 + 0.06) / 2, 1e-12);
  EXPECT_EQ(row.metres.over_seeds.confidence, 0.75);
  EXPECT_NEAR(row.metres.worst.value(), 0.06, 1e-12);
  EXPECT_EQ(row.map_restarts, 6u);
  EXPECT_EQ(row.scale.median, 0.9);
  EXPECT_FALSE(row.scale_sigma.median);
  EXPECT_NEAR(row.end_drift.median.value(), 0.3, 1e-12) << "of the five runs that have one";
  const BenchmarkRow& every_motion = all.rows[2];
  EXPECT_FALSE(every_motion.motion);
  EXPECT_EQ(every_motion.pieces, 4u);
  EXPECT_NEAR(every_motion.metres.worst.value(), 0.12, 1e-12);
  EXPECT_EQ(all.rows[3].set, 1u);
  EXPECT_NEAR(all.rows[3].percent.median.value(), 100 * (0.14 + 0.17) / 2 / 4, 1e-9);
}

TEST_F(FlightBenchmark, CountsWhatDiverged) {
  outcomes_[0].ate_m = 2.5;  // above the path of 2 m
  outcomes_[1].ate_m.reset();
  outcomes_[1].failure = "a pose is no number";
  const BenchmarkResult all = result();
  EXPECT_EQ(all.pieces[0].diverged, 2u);
  EXPECT_FALSE(all.pieces[0].percent.median);
  EXPECT_NEAR(all.pieces[0].percent.low.value(), 1.5, 1e-9);
  EXPECT_EQ(all.rows[0].diverged, 2u);
  EXPECT_FALSE(all.rows[0].percent.worst);
  EXPECT_FALSE(all.rows[0].percent.median) << "of a piece that diverged and one that did not";
  EXPECT_EQ(all.rows[2].percent.median.has_value(), true) << "of four pieces, one diverged";
  EXPECT_EQ(all.rows[3].diverged, 0u);
  EXPECT_EQ(rows_json(benchmark_rows(benchmark_, all)).at(0).at("diverged"), 2);
  EXPECT_TRUE(rows_json(benchmark_rows(benchmark_, all)).at(0).at("ate_percent").is_null());
}

TEST_F(FlightBenchmark, SaysWhetherRunsKnewThatTheyWereWrong) {
  for (RunOutcome& outcome : outcomes_) outcome.health = Health::good;
  EXPECT_EQ(result().rows[0].failed, 0u);
  outcomes_[0].ate_m = 0.5;  // of 2 m: 25 %, and good
  outcomes_[1].ate_m = 0.3;  // 15 %
  outcomes_[1].health = Health::unreliable;
  outcomes_[2].ate_m.reset();
  outcomes_[2].health = Health::lost;
  outcomes_[3].health = Health::unreliable;  // 2 %
  const BenchmarkRow row = result().rows[0];
  EXPECT_EQ(row.failed, 3u);
  EXPECT_EQ(row.alarms.failed, 3u);
  EXPECT_EQ(row.alarms.detected, 2u);
  EXPECT_EQ(row.alarms.right, 2u) << "2 and 2.5 %; 3 % is not below 3";
  EXPECT_EQ(row.alarms.false_alarms, 1u);
  EXPECT_EQ(row.alarms.silent, 1u);
  outcomes_[0].health.reset();
  EXPECT_EQ(result().rows[0].alarms.failed, 2u) << "what says nothing does not count";
}

TEST_F(FlightBenchmark, JudgesTheSameOfARunAsItsVerdict) {
  for (RunOutcome& outcome : outcomes_) outcome.health = Health::good;
  outcomes_[0].ate_m = 0.5;  // of 2 m: 25 % with poses that the run calls guesses
  EXPECT_EQ(result().rows[0].alarms.silent, 1u);
  outcomes_[0].located_m = 0.01;  // 0.5 % without
  EXPECT_EQ(result().rows[0].alarms.silent, 0u);
  EXPECT_EQ(result().rows[0].alarms.failed, 0u);
  EXPECT_EQ(result().rows[0].failed, 1u) << "its poses are wrong all the same";
  const Json run = rows_json(benchmark_runs_table(benchmark_, runs_, outcomes_, {})).at(0);
  EXPECT_NEAR(run.at("ate_percent").get<double>(), 25, 1e-9);
  EXPECT_NEAR(run.at("located_percent").get<double>(), 0.5, 1e-9);
}

TEST_F(FlightBenchmark, TellsTheSameInAllItsForms) {
  const BenchmarkResult all = result();
  const Table rows = benchmark_rows(benchmark_, all);
  const std::string text = terminal_text(rows, kAnyWidth) + benchmark_notes(benchmark_, all, "  ");
  for (const char* part :
       {"90 frames", "development", "fresh", "0.035", "1.75", "1.00", "2.50", "50 % (2 values)",
        "75 % (3 values)", "left out of these starts: 2 at rest, 3 too near the end",
        "fresh: worlds 2"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  const Json json = rows_json(rows);
  ASSERT_EQ(json.size(), 6u);
  EXPECT_EQ(json.at(0).at("ate_m"), 0.035);
  EXPECT_EQ(json.at(0).at("ate_percent_low"), 1);
  EXPECT_EQ(json.at(0).at("ate_percent_seeds_low"), 1.25);
  EXPECT_EQ(json.at(2).at("motion"), "all");
  const Json pieces = rows_json(piece_rows(benchmark_, all));
  ASSERT_EQ(pieces.size(), 8u);
  EXPECT_EQ(pieces.at(7).at("set"), "fresh");
  EXPECT_EQ(pieces.at(7).at("ate_m"), 0.23);
  const Table runs = benchmark_runs_table(benchmark_, runs_, outcomes_, {});
  const std::string csv = csv_text(runs);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 24);
  const Json page = study_report(benchmark_page(benchmark_, all, runs));
  EXPECT_EQ(page.at("study").at("axes"), Json::array({"path_m", "ate_percent"}));
  EXPECT_EQ(page.at("study").at("table").at("ate_percent").size(), 24u);
  EXPECT_EQ(page.at("study").at("colour"), "set");
}

}  // namespace
}  // namespace leviosim::tools
