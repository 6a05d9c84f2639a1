// A replay on the chip of the recording is the run; on another chip it is what a live run there
// would be as long as the algorithm sees the same, and says so where it does not.
#include "tools/app/run/replay.h"
#include "tools/app/run/recording_source.h"
#include "tools/app/run/replay_report.h"
#include "tools/app/run/run_observer.h"
#include "tools/app/run/simulate.h"
#include "tools/app/run/trace_source.h"

#include <gtest/gtest.h>

#include "sim/work/op.h"
#include "tests/tools/statistic_values.h"
#include "tests/traces/test_folder.h"
#include "tools/app/record/statistics.h"
#include "tools/app/report/tables.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_tables.h"
#include "tools/app/run/workload_options.h"
#include "traces/synthesis/synthetic.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

using traces::testing::expect_input_error;

/// Three seconds of synthetic flight, made once for all tests of this program.
const std::filesystem::path& flight() {
  static const std::filesystem::path folder = [] {
    const auto path = std::filesystem::temp_directory_path() /
                      fmt::format("leviosim-{}-replay-flight", ::getpid());
    traces::write_synthetic_flight(path, {.duration_s = 3, .texel_m = 0.01});
    return path;
  }();
  return folder;
}

RunRequest request_on(const std::vector<std::string>& overrides, int cores = 8) {
  RunRequest request;
  request.data = flight();
  request.cores = cores;
  request.platform = platform::resolve_platform("gap9", overrides);
  return request;
}

RunResult live(RunRequest request, RunObserver* observer = nullptr) {
  request.observer = observer;
  return simulate(request, [](const Progress&) {});
}

struct Recorded {
  RunResult run;
  std::unique_ptr<traces::WorkTrace> trace;
};

Recorded record(RunRequest request) {
  WorkRecording recording(request.cores);
  request.recording = &recording;
  Recorded recorded;
  recorded.run = live(request);
  recording.info.platform = "gap9";
  recording.info.platform_yaml = platform::to_yaml(request.platform);
  recorded.trace = std::make_unique<traces::WorkTrace>(
      "work.trace", recording.writer.finish(std::move(recording.info)));
  return recorded;
}

/// Of gap9 as it is, made once.
const Recorded& on_gap9() {
  static const Recorded recorded = record(request_on({}));
  return recorded;
}

Replay replayed(const traces::WorkTrace& trace, const std::vector<std::string>& overrides,
                RunObserver* observer = nullptr, int cores = 8) {
  RunRequest request = request_on(overrides, cores);
  request.observer = observer;
  return replay(trace, request, [](const Progress&) {});
}

/// Everything that a run folder holds of a run, but the manifest.
std::vector<std::string> files_of(const RunResult& run) {
  return {testing::figures_text(run), csv_text(stage_rows(run)),
          csv_text(frame_rows(run)),  csv_text(memory_rows(run)),
          csv_text(energy_rows(run)), traces::format_tum(run.trajectory)};
}

bool all_the_same(const Replay& replay) {
  return std::all_of(replay.frames.begin(), replay.frames.end(),
                     [](const FrameComparison& f) { return f.computes_the_same(); });
}

class Replayed : public ::testing::Test {
 protected:
  static void TearDownTestSuite() { std::filesystem::remove_all(flight()); }
};

TEST_F(Replayed, OnTheChipOfTheRecordingGivesTheSameFiles) {
  const Replay again = replayed(*on_gap9().trace, {});
  EXPECT_EQ(files_of(again.run), files_of(on_gap9().run));
  EXPECT_EQ(again.frames.size(), on_gap9().run.frames.size());
  EXPECT_TRUE(all_the_same(again));
  EXPECT_NE(replay_report(again, *on_gap9().trace).find("computes the same"), std::string::npos);
}

TEST_F(Replayed, EveryProfileComesBack) {
  for (const std::string& profile : vio::profile_names()) {
    RunRequest request = request_on({});
    request.profile = profile;
    const Recorded recorded = record(request);
    EXPECT_EQ(files_of(replayed(*recorded.trace, {}).run), files_of(recorded.run)) << profile;
  }
}

TEST_F(Replayed, RecordingChangesNothing) {
  EXPECT_EQ(files_of(on_gap9().run), files_of(live(request_on({}))));
}

/// Chips on which the optimiser keeps up, so that the algorithm sees the same.
TEST_F(Replayed, OnAnotherChipIsTheLiveRunThere) {
  for (const std::vector<std::string>& overrides :
       {std::vector<std::string>{"cluster.fpu.units=1", "isa.ops.load_stream.issue=1.3"},
        {"cluster.clock=240MHz", "controller.clock=330MHz"},
        {"cluster.icache.shared_size=2KiB", "cluster.dma.bytes_per_cycle=2",
         "cluster.l1.banks=8"}}) {
    const Replay there = replayed(*on_gap9().trace, overrides);
    ASSERT_TRUE(all_the_same(there)) << overrides[0];
    const RunResult run = live(request_on(overrides));
    EXPECT_EQ(files_of(there.run), files_of(run)) << overrides[0];
    EXPECT_NE(files_of(there.run), files_of(on_gap9().run)) << overrides[0];
  }
}

/// On chips with accelerators, from a trace of one without.
TEST_F(Replayed, OnAChipWithAcceleratorsIsTheLiveRunThere) {
  for (const char* chip : {"gap9-eigen", "gap9-hamming", "gap9-corners"}) {
    RunRequest request = request_on({});
    request.platform = platform::resolve_platform(chip);
    const Replay there = replay(*on_gap9().trace, request, [](const Progress&) {});
    ASSERT_TRUE(all_the_same(there)) << chip;
    EXPECT_EQ(files_of(there.run), files_of(live(request))) << chip;
    EXPECT_LT(there.run.frames.back().cycles, on_gap9().run.frames.back().cycles) << chip;
    // What is computed is the same.
    EXPECT_EQ(traces::format_tum(there.run.trajectory),
              traces::format_tum(on_gap9().run.trajectory));
    EXPECT_NE(testing::figures_text(there.run).find(".served."), std::string::npos);
  }
  EXPECT_EQ(testing::figures_text(on_gap9().run).find(".served."), std::string::npos);
}

TEST_F(Replayed, OtherNumbersOfCoresHaveTracesOfTheirOwn) {
  const Recorded three = record(request_on({}, 3));
  EXPECT_EQ(files_of(replayed(*three.trace, {}, nullptr, 3).run), files_of(three.run));
  expect_input_error([&] { replayed(*three.trace, {}); },
                     {"3 cores", "--cores 3", "record again", "--cores 8"});
  expect_input_error([&] { replayed(*on_gap9().trace, {}, nullptr, 4); }, {"8 cores", "--cores 4"});
}

/// Divisions so slow that optimisations last longer than a frame once there is enough to optimise.
const std::vector<std::string> kSlowController{"controller.core.ops.f32_div.stall=100000"};

TEST_F(Replayed, NamesTheFramesThatWouldSeeAnotherResult) {
  const Replay slow = replayed(*on_gap9().trace, kSlowController);
  const RunResult run = live(request_on(kSlowController));
  const auto first = std::find_if(slow.frames.begin(), slow.frames.end(),
                                  [](const auto& f) { return !f.computes_the_same(); });
  ASSERT_NE(first, slow.frames.end());
  EXPECT_GT(slow.run.optimiser_late, 0);
  // Up to there, all frames take what they take live.
  for (int i = 0; i < first->frame; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_EQ(slow.run.frames[k].end_ns, run.frames[k].end_ns) << i;
    EXPECT_EQ(slow.run.frames[k].single_cycles, run.frames[k].single_cycles) << i;
  }
  EXPECT_NE(replay_report(slow, *on_gap9().trace)
                .find(fmt::format("something else from frame {} on", first->frame)),
            std::string::npos);
  const std::string csv = replay_csv(slow);
  EXPECT_NE(csv.find(fmt::format("\n{},0,", first->frame)), std::string::npos);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'),
            static_cast<std::ptrdiff_t>(slow.frames.size() + 1));
}

/// Late optimisations are part of a recording like everything else.
TEST_F(Replayed, ARecordingWithLateOptimisationsIsReproducedToo) {
  const Recorded slow = record(request_on(kSlowController));
  ASSERT_GT(slow.run.optimiser_late, 0);
  const Replay again = replayed(*slow.trace, kSlowController);
  EXPECT_EQ(files_of(again.run), files_of(slow.run));
  EXPECT_TRUE(all_the_same(again));
  // On a chip that keeps up, optimisations would begin that were not recorded.
  const Replay fast = replayed(*slow.trace, {});
  EXPECT_FALSE(all_the_same(fast));
  EXPECT_EQ(fast.run.optimiser_late, 0);
}

TEST_F(Replayed, NamesTheFramesThatWait) {
  const Replay slow =
      replayed(*on_gap9().trace, {"cluster.clock=100MHz", "controller.clock=100MHz"});
  const auto waits = [](const FrameComparison& f) { return f.replayed.waited_ns > 0; };
  ASSERT_TRUE(std::any_of(slow.frames.begin(), slow.frames.end(), waits));
  EXPECT_NE(replay_report(slow, *on_gap9().trace).find("wait for the front end"),
            std::string::npos);
  for (const FrameComparison& f : slow.frames)
    EXPECT_EQ(f.replayed.waited_ns,
              slow.run.frames[static_cast<std::size_t>(f.frame)].start_ns -
                  slow.run.frames[static_cast<std::size_t>(f.frame)].arrival_ns);
}

TEST_F(Replayed, WhatDoesNotFitTheMemoriesIsRefused) {
  expect_input_error([] { replayed(*on_gap9().trace, {"cluster.l1.size=64KiB"}); },
                     {"work.trace", "frame 1", "world matching", "L1", "bytes are missing"});
  expect_input_error([] { replayed(*on_gap9().trace, {"l2.size=64KiB"}); },
                     {"L2", "bytes are missing"});
}

class Jobs : public RunObserver {
 public:
  void on_front_end(const FrontEndJob& e) override {
    for (const work::StageRun& stage : e.job.stages) sum_ += work::counts_of(stage);
  }
  void on_optimiser(const OptimiserJob& e) override {
    for (const work::StageRun& stage : e.job.stages) sum_ += work::counts_of(stage);
  }
  const work::Counts& sum() const { return sum_; }

 private:
  work::Counts sum_;
};

/// Without the compiled work of instruction sets that are not the chip's, which replays do not
/// read.
work::Counts as_on_gap9(work::Counts counts) {
  constexpr auto kCode = work::CompiledFor::Rv32imfcXpulp;
  const auto own = work::compiled_of(counts.compiled, kCode);
  counts.compiled = {};
  work::set_compiled(counts.compiled, kCode, own);
  return counts;
}

/// With the code that it fetches, which no file of a run shows.
TEST_F(Replayed, ObserversSeeTheSameWork) {
  Jobs in_run;
  Jobs in_replay;
  live(request_on({}), &in_run);
  replayed(*on_gap9().trace, {}, &in_replay);
  EXPECT_EQ(as_on_gap9(in_run.sum()), as_on_gap9(in_replay.sum()));
  EXPECT_GT(in_run.sum()[work::Op::F32Fma], 0u);
}

TEST(ReplayOfRealFrames, IsTheRunAndSmall) {
  const auto folder = traces::testing::recorded_data() / "euroc" / "MH_01_easy_t05_t20";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "no recorded flight: set LEVIOSIM_DATA to the folder that contains euroc/";
  RunRequest request = request_on({});
  request.data = folder;
  request.frames = traces::FrameRange{50, 150};
  const Recorded recorded = record(request);
  const Replay again = replayed(*recorded.trace, {});
  EXPECT_EQ(files_of(again.run), files_of(recorded.run));
  EXPECT_LE(recorded.trace->file_size(), 100u * 20'000u);
}

/// A start in motion: run and trace have the poses as the alignment corrected them.
TEST(ReplayOfRealFrames, HasThePosesThatWaited) {
  const auto folder = traces::testing::recorded_data() / "euroc" / "MH_01_easy_t05_t20";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "no recorded flight: set LEVIOSIM_DATA to the folder that contains euroc/";
  RunRequest request = request_on({});
  request.data = folder;
  request.profile = "next";
  request.frames = traces::FrameRange{50, 130};
  const Recorded recorded = record(request);
  EXPECT_EQ(files_of(replayed(*recorded.trace, {}).run), files_of(recorded.run));
  request.workload = {{&workload_parameter("test", "workload.initialisation.wait"), 0}};
  const RunResult online = live(request);
  const FrameResult &waited = recorded.run.frames[3], &at_once = online.frames[3];
  EXPECT_EQ(waited.source, PoseSource::Initialising);
  EXPECT_EQ(at_once.source, PoseSource::Initialising);
  EXPECT_EQ(waited.pose_state(), vio::PoseState::Located);
  EXPECT_EQ(at_once.pose_state(), vio::PoseState::Initialising);
  EXPECT_LT(recorded.run.ate->translation.rmse, 0.5 * online.ate->translation.rmse);
  EXPECT_EQ(figures_of(recorded.run).map.guesses, 0);
  EXPECT_GT(figures_of(online).map.located_from, online.frames[3].index);
}

}  // namespace
}  // namespace leviosim::tools
