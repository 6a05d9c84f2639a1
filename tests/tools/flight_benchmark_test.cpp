// Benchmarks of flights: where pieces begin, what a plan may say, how runs are condensed.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/traces/test_folder.h"
#include "tools/app/study/flights/benchmark_files.h"
#include "tools/app/study/flights/benchmark_report.h"
#include "traces/datasets/rng.h"

namespace leviosim::tools {
namespace {

using traces::FrameRange;
using traces::testing::AslFolder;
using traces::testing::expect_input_error;
using traces::testing::TempFolder;

/// At rest but for one stretch, in which it moves along x.
traces::Trajectory moving_between(double begin_s, double end_s, double speed) {
  traces::Trajectory truth;
  for (int i = 0; i <= 100 * 100; ++i) {
    const double t = i / 100.0;
    traces::StampedPose& pose = truth.emplace_back();
    pose.t_ns = std::int64_t{i} * 10'000'000;
    pose.T_world_body.translation() << speed * (std::clamp(t, begin_s, end_s) - begin_s), 0, 1;
  }
  return truth;
}

std::vector<std::int64_t> stamps(int frames, std::int64_t first_ns) {
  std::vector<std::int64_t> all;
  for (int i = 0; i < frames; ++i) all.push_back(first_ns + std::int64_t{i} * 50'000'000);
  return all;
}

TEST(FlightStarts, AreEverySoManySecondsWhereTheVehicleMoves) {
  const traces::Trajectory truth = moving_between(19, 70.5, 0.5);
  const Starts starts = starts_in_motion(stamps(1990, 10'000'000), truth, 20);
  EXPECT_EQ(starts.frames, (std::vector<std::size_t>{400, 800, 1200}));
  EXPECT_EQ(starts.at_rest, 1u) << "after 80 s";
}

TEST(FlightStarts, AskForATenthOfAMetreInASecond) {
  const auto starts_at = [](double speed) {
    return starts_in_motion(stamps(500, 0), moving_between(0, 100, speed), 20).frames.size();
  };
  EXPECT_EQ(starts_at(0.099), 0u);
  EXPECT_EQ(starts_at(0.101), 1u);
}

TEST(FlightStarts, TakeTheFirstFrameAfterTheTime) {
  std::vector<std::int64_t> late = stamps(100, 0);
  late.erase(late.begin() + 20, late.begin() + 23);  // no frame at 1.00, 1.05 and 1.10 s
  const Starts starts = starts_in_motion(late, moving_between(0, 100, 1), 1);
  EXPECT_EQ(starts.frames, (std::vector<std::size_t>{20, 37, 57, 77}));
  EXPECT_EQ(late[20], 1'150'000'000);
}

TEST(FlightStarts, NeverTakeAFrameTwice) {
  const Starts starts = starts_in_motion(stamps(4, 0), moving_between(0, 100, 1), 0.01);
  EXPECT_EQ(starts.frames, (std::vector<std::size_t>{1, 2, 3}));
}

TEST(FlightStarts, TakeAsLongAsThereAreFrames) {
  std::vector<std::int64_t> apart = stamps(4, 0);
  apart.back() = 9'000'000'000'000'000'000;
  const Starts starts = starts_in_motion(apart, moving_between(0, 100, 1), 0.01);
  EXPECT_EQ(starts.frames, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(starts.at_rest, 1u);
}

TEST(FlightStarts, PathsAreThoseOfTheTruth) {
  const traces::Trajectory truth = moving_between(10, 20, 0.5);
  EXPECT_NEAR(true_path_m(truth, 0, 100'000'000'000), 5, 1e-9);
  EXPECT_NEAR(true_path_m(truth, 12'000'000'000, 14'000'000'000), 1, 1e-9);
  EXPECT_EQ(true_path_m(truth, 30'000'000'000, 40'000'000'000), 0);
}

std::string text_of(const std::vector<FrameRange>& ranges) {
  std::string text;
  for (const FrameRange& range : ranges) text += fmt::format("{}:{} ", range.begin, range.end);
  return text;
}

TEST(FlightStarts, RangesThatTouchAreDrawnAsOne) {
  EXPECT_EQ(text_of(merged({{8, 9}, {0, 2}, {2, 4}, {3, 4}, {6, 8}})), "0:4 6:9 ");
  const std::vector<FrameRange> drawn{{2, 5}, {10, 14}};
  EXPECT_EQ(text_of({within(drawn, {3, 5})}), "1:3 ");
  EXPECT_EQ(text_of({within(drawn, {11, 14})}), "4:7 ");
}

constexpr const char* kPlan =
    "motions: [a, b]\nworlds: { development: [1], fresh: [2, 3] }\npieces: [3, whole]\n";

TEST(FlightPlans, AreReadWithTheirDefaults) {
  const FlightPlan plan = parse_flight_plan("p.yaml", kPlan);
  EXPECT_EQ(plan.motions, (std::vector<std::string>{"a", "b"}));
  ASSERT_EQ(plan.sets.size(), 2u);
  EXPECT_EQ(plan.sets[1].name, "fresh");
  EXPECT_EQ(plan.sets[1].worlds, (std::vector<traces::Place>{{.seed = 2}, {.seed = 3}}));
  EXPECT_EQ(plan.lengths, (std::vector<std::size_t>{3, kWholeFlight}));
  EXPECT_EQ(plan.every_s, 20);
  EXPECT_EQ(plan.seeds, (std::vector<std::uint32_t>{1, 2, 3}));
  ASSERT_EQ(plan.variants.size(), 1u);
  EXPECT_EQ(plan.variants[0].name(), "next");
  const FlightPlan more = parse_flight_plan(
      "p.yaml", std::string(kPlan) +
                    "every: 2.5\nseeds: [7]\nsize: 32x24\nvariants:\n  - { profile: levio }\n"
                    "  - { profile: next, workload.window: 8, workload.guided: off }\n");
  EXPECT_EQ(more.every_s, 2.5);
  EXPECT_EQ(more.size.width, 32);
  ASSERT_EQ(more.variants.size(), 2u);
  EXPECT_EQ(more.variants[1].name(), "next window=8 guided=off");
}

TEST(FlightPlans, ThatHaveNamesAreWhole) {
  EXPECT_GE(builtin_flight_plans().size(), 5u);
  for (const base::BuiltinFile& file : builtin_flight_plans()) {
    const FlightPlan plan = flight_plan_named(std::string(file.name));
    EXPECT_EQ(plan.name, file.name);
    if (file.name == "distances") {  // nothing is chosen there; a set for each distance
      EXPECT_EQ(plan.sets.size(), 5u);
      continue;
    }
    ASSERT_EQ(plan.sets.size(), 2u) << file.name;
    EXPECT_EQ(plan.sets[0].name, "development");
    EXPECT_EQ(plan.sets[1].name, "fresh");
  }
  expect_input_error([] { flight_plan_named("mid-ari"); },
                     {"'mid-ari'", "did you mean 'mid-air'", "or a file"});
}

TEST(FlightPlans, RefuseFaultsWithTheirPlace) {
  const auto refuse = [](const std::string& from, const std::string& to,
                         std::initializer_list<std::string> parts) {
    std::string text = kPlan;
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    expect_input_error([&] { parse_flight_plan("p.yaml", text); }, parts);
  };
  refuse("motions", "motion", {"p.yaml:1: motion", "did you mean 'motions'"});
  refuse("pieces: [3, whole]", "", {"p.yaml", "missing key 'pieces'"});
  refuse("[a, b]", "[]", {"p.yaml:1: motions", "is empty"});
  refuse("[a, b]", "[a, ../b]", {"p.yaml:1: motions", "'../b' is no plain name"});
  refuse("[a, b]", "[a, a]", {"p.yaml:1: motions", "'a' is given twice"});
  refuse("[a, b]", "a", {"p.yaml:1: motions", "is a single value; expected a list"});
  refuse("[2, 3]", "[1, 3]", {"p.yaml:2: worlds.fresh", "world 1 is in another set"});
  refuse("[2, 3]", "[-2]", {"p.yaml:2: worlds.fresh", "'-2'", "a whole number from 0"});
  refuse("3, whole", "2", {"p.yaml:3: pieces", "'2'", "from 3 to 1000000, rest, or whole"});
  refuse("3, whole", "all", {"p.yaml:3: pieces", "'all'", "or whole"});
  const auto refuse_more = [&](const std::string& line, std::initializer_list<std::string> parts) {
    expect_input_error([&] { parse_flight_plan("p.yaml", kPlan + line); }, parts);
  };
  refuse_more("every: 0", {"p.yaml:4: every", "'0'", "above 0"});
  for (const char* every : {"0.001", "86401", "1e10", "1e300"})
    refuse_more(fmt::format("every: {}", every),
                {"p.yaml:4: every", every, "expected 0.01 to 86400 s"});
  for (const char* every : {"nan", "-1", "1e999"})
    refuse_more(fmt::format("every: {}", every), {"p.yaml:4: every", every});
  refuse_more("seeds: [x]", {"p.yaml:4: seeds", "'x'"});
  refuse_more("size: 32", {"p.yaml:4: size", "32"});
  refuse_more("variants: []", {"p.yaml:4: variants", "is empty"});
  refuse_more("variants: [{ profile: nxet }]", {"p.yaml:4: variants.profile", "nxet"});
  refuse_more("variants: [{ workload.windw: 8 }]",
              {"p.yaml:4: variants.workload.windw", "did you mean 'workload.window'"});
  refuse_more("variants: [{ workload.window: 99 }]", {"p.yaml:4", "'99'", "from 2 to 32"});
  refuse_more("variants: [{ profile: next }, {}]", {"p.yaml", "'next' is given twice"});
}

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
  EXPECT_NE(benchmark_text(benchmark_, all, kAnyWidth).find("2 of 6"), std::string::npos);
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

TEST_F(FlightBenchmark, TellsTheSameInAllItsForms) {
  const BenchmarkResult all = result();
  const std::string text = benchmark_text(benchmark_, all, kAnyWidth);
  for (const char* part :
       {"90 frames", "development", "fresh", "0.035", "1.75", "1.00 … 2.50", "1.25 … 2.25",
        "50 % (2 values)", "75 % (3 values)",
        "left out of these starts: 2 at rest, 3 too near the end", "fresh: worlds 2"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  const Json json = benchmark_json(benchmark_, all);
  ASSERT_EQ(json.at("rows").size(), 6u);
  EXPECT_EQ(json.at("rows")[0].at("ate").at("median"), 0.035);
  EXPECT_EQ(json.at("rows")[0].at("ate_percent").at("over_seeds").at("low"), 1.25);
  EXPECT_TRUE(json.at("rows")[2].at("motion").is_null());
  ASSERT_EQ(json.at("pieces").size(), 8u);
  EXPECT_EQ(json.at("pieces")[7].at("set"), "fresh");
  EXPECT_EQ(json.at("pieces")[7].at("ate_m"), 0.23);
  const std::string csv = benchmark_runs_csv(benchmark_, runs_, outcomes_, {});
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 24);
  const Json page = benchmark_page(benchmark_, all, csv);
  EXPECT_EQ(page.at("study").at("axes"), Json::array({"path_m", "ate_percent"}));
  EXPECT_EQ(page.at("study").at("table").at("ate_percent").size(), 24u);
  EXPECT_EQ(page.at("study").at("colour"), "set");
}

/// The motion of AslFolder: six frames, 20 m/s.
class FlightPieces : public ::testing::Test {
 protected:
  FlightPieces() { std::filesystem::create_directory_symlink(data_.root(), folder_ / "a"); }
  Benchmark benchmark(const std::string& pieces) const {
    return make_benchmark(
        parse_flight_plan("p.yaml",
                          "motions: [a]\nworlds: { one: [1], two: [2, 3] }\nsize: 32x24\n"
                          "every: 0.1\npieces: " +
                              pieces),
        folder_.path().string());
  }

  AslFolder data_;
  TempFolder folder_;
};

TEST_F(FlightPieces, BeginAtTheStartsAndEndWithinTheFlight) {
  const Benchmark some = benchmark("[3]");
  ASSERT_EQ(some.pieces.size(), 3u) << "frames 2 to 4 in each world; frame 4 is too late";
  EXPECT_EQ(some.too_late, 1u);
  for (const FlightPiece& piece : some.pieces) {
    EXPECT_EQ(text_of({piece.frames}), "2:5 ");
    EXPECT_NEAR(piece.start_s, 0.1, 1e-9);
    EXPECT_NEAR(piece.path_m, 2, 1e-6);
  }
  EXPECT_EQ(some.pieces[0].set, 0u);
  EXPECT_EQ(some.pieces[2].world.seed, 3u);
  ASSERT_EQ(drawn_flights(some).size(), 3u);
  EXPECT_EQ(text_of(drawn_flights(some)[0].frames), "2:5 ");
  EXPECT_EQ(benchmark("[4]").pieces.size(), 3u) << "up to the last frame";
  const Benchmark both = benchmark("[3, whole]");
  EXPECT_EQ(both.pieces.size(), 6u);
  EXPECT_EQ(text_of(drawn_flights(both)[0].frames), "0:6 ");
  expect_input_error([&] { benchmark("[5]"); }, {"p.yaml", "no piece", "0.1 s"});
}

TEST_F(FlightPieces, OfRecordingsBeginAtFramesAndNeedNoDrawing) {
  std::filesystem::create_directory_symlink(data_.root(), folder_ / "b");
  const Benchmark some = make_benchmark(
      parse_flight_plan("p.yaml",
                        "recordings: [b]\nstarts: { even: [0, 2], odd: [1, 2] }\nsize: 32x24\n"
                        "pieces: [3, rest]\nseeds: [1]\ndisturbances: [none, noise=9]\n"),
      folder_.path().string());
  std::string ranges;
  for (const FlightPiece& piece : some.pieces)
    if (piece.disturbance == 1) ranges += text_of({piece.frames});
  EXPECT_EQ(ranges, "0:3 2:5 1:4 3:6 0:6 2:6 1:6 ") << "rests are longer than three frames";
  EXPECT_EQ(some.pieces.size(), 14u);
  EXPECT_TRUE(drawn_flights(some).empty());
  const std::vector<Point> runs = benchmark_runs(some);
  ASSERT_EQ(runs.size(), 14u);
  std::set<std::string> keys;
  for (const Point& run : runs) keys.insert(run_key(run, {}, platform::Schema()));
  EXPECT_EQ(keys.size(), 14u);
  EXPECT_EQ(runs[1].request.disturbance.text(), "noise=9");
  EXPECT_EQ(text_of({*runs[3].request.frames}), "2:5 ");
}

TEST(FlightPlans, OfRecordingsNeedStarts) {
  const auto refuse = [](const std::string& text, std::initializer_list<std::string> parts) {
    expect_input_error([&] { parse_flight_plan("p.yaml", text + "\npieces: [3]"); }, parts);
  };
  refuse("recordings: [a]", {"missing key 'starts'"});
  refuse("recordings: [a]\nstarts: { x: [1] }", {"p.yaml:2: starts.x", "[FIRST, STEP]"});
  refuse("recordings: [a]\nstarts: { x: [1, 0] }", {"p.yaml:2: starts.x", "'0'"});
  refuse("recordings: [a]\nstarts: { x: [1, 2] }\ndisturbances: [nosie=1]",
         {"p.yaml:3: disturbances", "did you mean 'noise'"});
}

TEST_F(FlightPieces, NeedTheRecordedImu) {
  std::filesystem::remove(data_.mav0("imu0/data.csv"));
  expect_input_error([&] { benchmark("[3]"); }, {"a: there is no imu0/data.csv"});
}

}  // namespace
}  // namespace leviosim::tools
