// Batches of runs: what a run is found again by, what is kept of it, how several are condensed.
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

#include "tests/traces/test_folder.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/finished_runs.h"
#include "tools/app/study/outcome_cache.h"
#include "tools/app/study/point.h"
#include "tools/app/study/runner.h"
#include "tools/app/study/sequence.h"
#include "tools/app/study/spread.h"
#include "tools/app/table/table_files.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using traces::testing::AslFolder;
using traces::testing::expect_input_error;
using traces::testing::TempFolder;

RunOutcome example_outcome() {
  RunOutcome outcome;
  outcome.ate_m = 0.1 + 0.2;  // not to be written in a few digits
  outcome.sub_trajectories = 3;
  outcome.frames = 300;
  outcome.matched = 299;
  outcome.completion = 1.0 / 3;
  outcome.path_m = 5.4;
  outcome.protocol = "SE3-aligned, \"quoted\"";
  return outcome;
}

RunRecord example_figures() { return record_of(example_outcome()); }

std::string text_of(const RunRecord& record) { return json_text(record_json(record)); }

RunRecord failed(const std::string& why) {
  RunRecord record;
  record.failure = why;
  return record;
}

Point example_run() {
  Point point;
  point.work = "data inputs 1:2";
  point.request.data = "folder";
  point.request.native = true;
  return point;
}

TEST(OutcomeCache, GivesBackWhatWasStored) {
  const TempFolder folder;
  const OutcomeCache cache(folder / "runs");
  const std::string key(64, 'a');
  EXPECT_FALSE(cache.find(key));
  cache.store(key, example_figures());
  const std::optional<RunRecord> found = cache.find(key);
  ASSERT_TRUE(found);
  EXPECT_EQ(text_of(*found), text_of(example_figures()));
  EXPECT_EQ(run_outcome_of(*found).ate_m, 0.1 + 0.2);
  EXPECT_FALSE(run_outcome_of(*found).relative_percent);
  EXPECT_FALSE(cache.find(std::string(64, 'b')));
}

TEST(OutcomeCache, TakesNoFileThatWasCutOffOrIsOfAnotherKind) {
  const TempFolder folder;
  const OutcomeCache cache(folder / "runs");
  const std::string key(64, 'a');
  cache.store(key, example_figures());
  const fs::path file = folder / "runs/aa" / (key + ".json");
  const std::string text = base::read_text_file(file);
  for (const std::string& broken :
       {std::string(), text.substr(0, text.size() / 2), std::string("{}"), std::string("[1]"),
        std::string(R"({"format":"leviosim outcome 0"})"), std::string("\xff\x00", 2)}) {
    outputs::write_file_atomically(file, broken);
    EXPECT_FALSE(cache.find(key)) << broken;
  }
}

TEST(OutcomeCache, BelievesNoFileOfAnotherKeyAndWritesItAnew) {
  const TempFolder folder;
  const OutcomeCache cache(folder / "runs");
  const std::string key(64, 'a');
  const std::string other(64, 'b');
  const RunRecord swapped = failed("another");
  cache.store(key, example_figures());
  cache.store(other, swapped);
  const fs::path file = folder / "runs/aa" / (key + ".json");
  fs::copy_file(folder / "runs/bb" / (other + ".json"), file, fs::copy_options::overwrite_existing);
  EXPECT_FALSE(cache.find(key));
  EXPECT_TRUE(cache.find(other));
  cache.store(key, example_figures());
  ASSERT_TRUE(cache.find(key));
  EXPECT_EQ(text_of(*cache.find(key)), text_of(example_figures()));
  cache.store(key, swapped);  // what is whole stays
  EXPECT_EQ(text_of(*cache.find(key)), text_of(example_figures()));
}

TEST(RunKey, DependsOnEverythingButTheFolder) {
  const Measure how;
  const platform::Schema schema;
  const std::string key = run_key(example_run(), how, schema);
  EXPECT_EQ(key.size(), 64u);
  Point elsewhere = example_run();
  elsewhere.request.data = "copy of the folder";
  EXPECT_EQ(run_key(elsewhere, how, schema), key);

  std::set<std::string> keys{key, run_key(example_run(), {traces::Alignment::sim3, 40}, schema),
                             run_key(example_run(), {traces::Alignment::se3, 20}, schema)};
  const auto add = [&](auto change) {
    Point other = example_run();
    change(other);
    keys.insert(run_key(other, how, schema));
  };
  add([](Point& p) { p.work = "data other inputs 1:2"; });
  add([](Point& p) { p.request.profile = "levio-no-imu"; });
  add([](Point& p) { p.request.seed = 2; });
  add([](Point& p) { p.request.image_size = {320, 240}; });
  add([](Point& p) { p.request.workload = {{vio::find_parameter("workload.window"), 6}}; });
  add([](Point& p) { p.request.workload = {{vio::find_parameter("workload.window"), 7}}; });
  EXPECT_EQ(keys.size(), 9u);
}

TEST(RunKey, IsOfTheParametersAsTheyAre) {
  const vio::Parameter* const window = vio::find_parameter("workload.window");
  const vio::Assignment huber{vio::find_parameter("workload.huber"), 2};
  const auto key = [](std::vector<vio::Assignment> workload) {
    Point point = example_run();
    point.request.workload = std::move(workload);
    return run_key(point, {}, platform::Schema());
  };
  EXPECT_EQ(key({{window, 6}, huber}), key({huber, {window, 6}}));
  EXPECT_EQ(key({{window, window->get(vio::profile_named("levio", 1))}}), key({}));
}

TEST(RunOutcome, AnEstimateThatDivergedIsAFailureAndNoFault) {
  traces::Trajectory truth;
  for (int i = 0; i < 10; ++i) {
    truth.push_back({i * 50'000'000, Eigen::Isometry3d::Identity()});
    truth.back().T_world_body.translation() << i, i % 3, 0;
  }
  EXPECT_NEAR(measure(truth, truth, {}).ate_m.value(), 0, 1e-9);
  EXPECT_FALSE(measure(truth, truth, {}).relative_percent);
  EXPECT_NEAR(measure(truth, truth, {.length_m = 3}).relative_percent.value(), 0, 1e-9);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 1e200}) {
    traces::Trajectory estimate = truth;
    estimate[4].T_world_body.translation().x() = bad;
    const RunOutcome outcome = measure(estimate, truth, {.length_m = 3});
    EXPECT_NE(outcome.failure, "");
    EXPECT_FALSE(outcome.ate_m);
    EXPECT_FALSE(outcome.relative_percent);
  }
}

TEST(RunOutcome, ARunSomeOfWhosePosesAreNoNumbersHasDiverged) {
  RunResult run;
  for (int i = 0; i < 10; ++i) {
    run.trajectory.push_back({i * 50'000'000, Eigen::Isometry3d::Identity()});
    run.trajectory.back().T_world_body.translation() << i, i % 3, 0;
  }
  run.frames.resize(12);
  const traces::Trajectory truth = run.trajectory;
  EXPECT_NEAR(outcome_of(run, truth, {}).ate_m.value(), 0, 1e-9);
  run.poses_left_out = 2;
  const RunOutcome diverged = outcome_of(run, truth, {});
  EXPECT_EQ(diverged.failure, "2 poses are NaN");
  EXPECT_FALSE(diverged.ate_m);
  EXPECT_EQ(diverged.frames, 12u);
}

TEST(Spread, TakesFailuresAsInfinitelyBad) {
  EXPECT_EQ(spread_of({}).runs, 0u);
  EXPECT_FALSE(spread_of({}).median);
  const Spread three = spread_of({3.0, 1.0, 2.0});
  EXPECT_EQ(three.median, 2);
  EXPECT_EQ(three.low, 1);
  EXPECT_EQ(three.high, 3);
  EXPECT_EQ(spread_of({1.0, 2.0}).median, 1.5);
  const Spread one_failed = spread_of({std::nullopt, 1.0, 2.0});
  EXPECT_EQ(one_failed.failed, 1u);
  EXPECT_EQ(one_failed.median, 2);
  EXPECT_FALSE(one_failed.high);
  EXPECT_FALSE(spread_of({std::nullopt, 1.0}).median);
}

TEST(Sequence, TakesItsNameFromTheFolderOrTheUser) {
  EXPECT_EQ(parse_named_folder("/data/MH_01_easy/").name, "MH_01_easy");
  EXPECT_EQ(parse_named_folder("/data/MH_01_easy").folder, "/data/MH_01_easy");
  EXPECT_EQ(parse_named_folder("MH=renders/a").name, "MH");
  EXPECT_EQ(parse_named_folder("MH=renders/a").folder, "renders/a");
  EXPECT_EQ(parse_named_folder("renders/a=b").name, "a=b");
  expect_input_error([] { parse_named_folder("a,b=x"); }, {"--data a,b=x", "NAME=DIR"});
  expect_input_error([] { parse_named_folder("=x"); }, {"empty"});
}

TEST(Sequence, RefusesWhatCannotBeUsed) {
  const AslFolder data;
  const NamedFolder named{"flight", data.root().string()};
  EXPECT_EQ(open_sequence(named, {}, {{32, 24}}).frames, 6u);
  EXPECT_NEAR(open_sequence(named, {}, {}).path_m, 5, 1e-9);
  EXPECT_EQ(open_sequence(named, traces::FrameRange{1, 3}, {}).frames, 2u);
  EXPECT_NE(open_sequence(named, traces::FrameRange{1, 3}, {}).inputs,
            open_sequence(named, {}, {}).inputs);
  EXPECT_NE(open_sequence(named, traces::FrameRange{1, 3}, {}).work,
            open_sequence(named, traces::FrameRange{2, 4}, {}).work);  // whose images are equal
  EXPECT_EQ(open_sequence(named, traces::FrameRange{0, 6}, {}).work,
            open_sequence(named, {}, {}).work);
  expect_input_error([&] { open_sequence(named, {}, {{64, 48}}); }, {"--data", "64x48"});
  fs::remove_all(data.mav0("state_groundtruth_estimate0"));
  expect_input_error([&] { open_sequence(named, {}, {}); }, {"no ground truth"});
}

class Batch : public ::testing::Test {
 protected:
  Batch() : sequence_(open_sequence({"flight", data_.root().string()}, {}, {})) {
    for (const char* profile : {"levio", "levio-no-imu"})
      for (const std::uint32_t seed : {1u, 2u, 3u}) {
        Point& run = runs_.emplace_back(example_run());
        run.sequence = &sequence_;
        run.work = sequence_.work;
        run.request.data = sequence_.folder;
        run.request.profile = profile;
        run.request.seed = seed;
        run.request.image_size = {32, 24};
      }
    runs_.push_back(runs_.front());  // the same again
  }
  std::string run(const std::string& cache, unsigned threads) {
    const std::vector<RunOutcome> outcomes =
        run_outcomes(runs_, {.length_m = 1}, {.threads = threads, .cache = folder_ / cache});
    return csv_text(run_rows(runs_, outcomes, {.length_m = 1}));
  }
  /// Of outcomes that are kept.
  std::size_t kept(const std::string& cache) const {
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / cache))
      count += entry.is_regular_file() ? 1 : 0;
    return count;
  }

  AslFolder data_;
  TempFolder folder_;
  Sequence sequence_;
  std::vector<Point> runs_;
};

TEST_F(Batch, IsTheSameWithAnyNumberOfThreadsAndFromTheCache) {
  const std::string one = run("a", 1);
  EXPECT_EQ(kept("a"), 6u);
  EXPECT_EQ(run("b", 3), one);
  outputs::write_file_atomically(data_.image(5), "no image");
  EXPECT_EQ(run("a", 2), one);  // which computes nothing
}

TEST_F(Batch, StoresNothingOfARunThatFails) {
  outputs::write_file_atomically(data_.image(5), "no image");
  expect_input_error([&] { run("a", 1); }, {data_.image(5).filename().string()});
  EXPECT_FALSE(fs::exists(folder_ / "a"));
}

TEST(Runner, ComputesEqualKeysOnceAndCountsAllOfThem) {
  const TempFolder folder;
  const std::string a(64, 'a'), b(64, 'b'), c(64, 'c');
  std::atomic<int> computed = 0;
  std::map<std::size_t, double> taken;
  PointBatch batch{.keys = {a, b, a, c, a}, .before = 2, .keeps_failures = false};
  batch.compute = [&](std::size_t point) {
    ++computed;
    RunRecord record = failed(point == 3 ? "too small" : "");
    record.statistics = {{.name = "x", .value = double(point)}};
    return record;
  };
  batch.take = [&](std::size_t point, const RunRecord& o) { taken[point] = o.value("x").value(); };
  const Tally first = run_points(batch, {.threads = 2, .cache = folder / "cache"});
  EXPECT_EQ(computed, 3);
  EXPECT_EQ(first.computed, 5u);
  EXPECT_EQ(first.done(), first.total);
  const std::map<std::size_t, double> expected{{0, 0}, {1, 1}, {2, 0}, {3, 3}, {4, 0}};
  EXPECT_EQ(taken, expected);
  taken.clear();
  const Tally second = run_points(batch, {.threads = 1, .cache = folder / "cache"});
  EXPECT_EQ(computed, 4);  // what failed is tried again
  EXPECT_EQ(second.found, 4u);
  EXPECT_EQ(second.total, 7u);
  EXPECT_EQ(taken, expected);
}

TEST(Runner, SaysHowLongItTakes) {
  const Tally tally{.total = 110, .before = 4, .found = 6, .computed = 20};
  EXPECT_EQ(progress_text("point", tally, 10),
            "point 30/110, 10 of them done before, 2.0 points/s, done in 0:00:40");
  EXPECT_EQ(progress_text("run", {.total = 32, .computed = 1}, 118.11),
            "run 1/32, 0.0 runs/s, done in 1:01:01");
  EXPECT_EQ(progress_text("run", {.total = 10, .found = 5}, 1), "run 5/10, 5 of them done before");
}

TEST(RunOutcome, RefusesKeptFiguresOfAnotherKind) {
  RunRecord figures = example_figures();
  figures.statistics.pop_back();
  expect_input_error([&] { run_outcome_of(figures); }, {"cache", "path_m"});
  figures = example_figures();
  for (Statistic& statistic : figures.statistics) statistic.value = 1e300;
  expect_input_error([&] { run_outcome_of(figures); }, {"cache", "sub_trajectories"});
}

}  // namespace
}  // namespace leviosim::tools
