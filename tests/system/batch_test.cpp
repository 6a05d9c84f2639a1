// Batches of runs: what a run is found again by, what is kept of it, how several are condensed.
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <set>

#include "tests/traces/test_folder.h"
#include "tools/app/study/batch/batch_options.h"
#include "tools/app/study/batch/run_key.h"
#include "tools/app/study/batch/runs_csv.h"
#include "tools/app/study/batch/spread.h"

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

RunRequest example_request() {
  RunRequest request;
  request.data = "folder";
  request.native = true;
  return request;
}

TEST(RunCache, GivesBackWhatWasStored) {
  const TempFolder folder;
  const RunCache cache(folder / "runs");
  const std::string key(64, 'a');
  EXPECT_FALSE(cache.find(key));
  cache.store(key, example_outcome());
  const std::optional<RunOutcome> found = cache.find(key);
  ASSERT_TRUE(found);
  EXPECT_EQ(to_text(*found), to_text(example_outcome()));
  EXPECT_EQ(found->ate_m, 0.1 + 0.2);
  EXPECT_FALSE(found->relative_percent);
  EXPECT_FALSE(cache.find(std::string(64, 'b')));
}

TEST(RunCache, TakesNoFileThatWasCutOffOrIsOfAnotherKind) {
  const TempFolder folder;
  const RunCache cache(folder / "runs");
  const std::string key(64, 'a');
  cache.store(key, example_outcome());
  const fs::path file = folder / "runs/aa" / (key + ".json");
  const std::string text = traces::read_text_file(file);
  for (const std::string& broken :
       {std::string(), text.substr(0, text.size() / 2), std::string("{}"), std::string("[1]"),
        std::string(R"({"format":"leviosim run outcome 0"})"), std::string("\xff\x00", 2)}) {
    traces::write_file_atomically(file, broken);
    EXPECT_FALSE(cache.find(key)) << broken;
  }
}

TEST(RunCache, BelievesNoFileOfAnotherKeyAndWritesItAnew) {
  const TempFolder folder;
  const RunCache cache(folder / "runs");
  const std::string key(64, 'a');
  const std::string other(64, 'b');
  RunOutcome swapped = example_outcome();
  swapped.ate_m = 7;
  cache.store(key, example_outcome());
  cache.store(other, swapped);
  const fs::path file = folder / "runs/aa" / (key + ".json");
  fs::copy_file(folder / "runs/bb" / (other + ".json"), file, fs::copy_options::overwrite_existing);
  EXPECT_FALSE(cache.find(key));
  EXPECT_TRUE(cache.find(other));
  cache.store(key, example_outcome());
  ASSERT_TRUE(cache.find(key));
  EXPECT_EQ(cache.find(key)->ate_m, example_outcome().ate_m);
  cache.store(key, swapped);  // what is whole stays
  EXPECT_EQ(cache.find(key)->ate_m, example_outcome().ate_m);
}

TEST(RunKey, DependsOnEverythingButTheFolder) {
  const RunRequest request = example_request();
  const Measure how;
  const std::string key = run_key(request, "inputs", how);
  EXPECT_EQ(key.size(), 64u);
  RunRequest elsewhere = request;
  elsewhere.data = "copy of the folder";
  EXPECT_EQ(run_key(elsewhere, "inputs", how), key);

  std::set<std::string> keys{key, run_key(request, "other inputs", how),
                             run_key(request, "inputs", {traces::Alignment::sim3, 40}),
                             run_key(request, "inputs", {traces::Alignment::se3, 20})};
  const auto add = [&](auto change) {
    RunRequest other = request;
    change(other);
    keys.insert(run_key(other, "inputs", how));
  };
  add([](RunRequest& r) { r.profile = "levio-no-imu"; });
  add([](RunRequest& r) { r.seed = 2; });
  add([](RunRequest& r) { r.image_size = {320, 240}; });
  add([](RunRequest& r) { r.frames = traces::FrameRange{0, 10}; });
  add([](RunRequest& r) { r.frames = traces::FrameRange{0, 11}; });
  add([](RunRequest& r) { r.workload = {{vio::find_parameter("workload.window"), 6}}; });
  add([](RunRequest& r) { r.workload = {{vio::find_parameter("workload.window"), 7}}; });
  EXPECT_EQ(keys.size(), 11u);
}

TEST(RunKey, DoesNotDependOnTheOrderOfParameters) {
  const vio::Assignment window{vio::find_parameter("workload.window"), 6};
  const vio::Assignment huber{vio::find_parameter("workload.huber"), 2};
  RunRequest a = example_request();
  RunRequest b = example_request();
  a.workload = {window, huber};
  b.workload = {huber, window};
  EXPECT_EQ(run_key(a, "", {}), run_key(b, "", {}));
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
  EXPECT_EQ(diverged.failure, "2 poses are no numbers");
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
  expect_input_error([&] { open_sequence(named, {}, {{64, 48}}); }, {"--data", "64x48"});
  fs::remove_all(data.mav0("state_groundtruth_estimate0"));
  expect_input_error([&] { open_sequence(named, {}, {}); }, {"no ground truth"});
}

class Batch : public ::testing::Test {
 protected:
  Batch() : sequence_(open_sequence({"flight", data_.root().string()}, {}, {})) {
    for (const char* profile : {"levio", "levio-no-imu"})
      for (const std::uint32_t seed : {1u, 2u, 3u}) {
        RunRequest request = example_request();
        request.data = sequence_.folder;
        request.profile = profile;
        request.seed = seed;
        request.image_size = {32, 24};
        runs_.push_back({&sequence_, request});
      }
    runs_.push_back(runs_.front());  // the same again
  }
  std::string run(const std::string& cache, unsigned threads) {
    const std::vector<RunOutcome> outcomes =
        run_batch(runs_, {{.length_m = 1}, RunCache(folder_ / cache), threads},
                  [&](const BatchProgress& progress) { last_ = progress; });
    return runs_csv(runs_, outcomes, {.length_m = 1});
  }

  AslFolder data_;
  TempFolder folder_;
  Sequence sequence_;
  std::vector<BatchRun> runs_;
  BatchProgress last_;
};

TEST_F(Batch, IsTheSameWithAnyNumberOfThreadsAndFromTheCache) {
  const std::string one = run("a", 1);
  EXPECT_EQ(last_.done, 7u);
  EXPECT_EQ(last_.found, 0u);
  EXPECT_EQ(run("b", 3), one);
  EXPECT_EQ(last_.found, 0u);
  EXPECT_EQ(run("a", 2), one);
  EXPECT_EQ(last_.done, 7u);
  EXPECT_EQ(last_.found, 7u);
}

TEST_F(Batch, StoresNothingOfARunThatFails) {
  traces::write_file_atomically(data_.image(5), "no image");
  expect_input_error([&] { run("a", 1); }, {data_.image(5).filename().string()});
  EXPECT_FALSE(fs::exists(folder_ / "a"));
}

}  // namespace
}  // namespace leviosim::tools
