// The summary of a run fits a screen, whatever the run.
#include "tools/app/report/run_summary.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "sim/energy/model.h"
#include "tests/sim/energy_test_config.h"
#include "tests/support/text_lines.h"
#include "tests/tools/example_run.h"

namespace leviosim::tools {
namespace {

using tests::lines_of;

constexpr const char* kHeading =
    "leviosim 0.1.0: next on gap9, 300 frames of DIR, 160x120, 8 cores at 370 MHz, controller at "
    "370 MHz, 0.8 V, camera at 20 frames/s (drop)";

/// As much as can be said of a run: many stages, energy, late frames, a wrong map.
RunResult eventful_run() {
  RunResult run = testing::example_run();
  run.chip = sim::energy_chip();
  const StageResult stage = run.stages.front();
  run.stages.clear();
  for (int i = 0; i < 20; ++i) {
    run.stages.push_back(stage);
    run.stages.back().name = fmt::format("optimiser iteration {:02}", i);
    run.stages.back().parallel = Cycles(1000 * (i + 1));
  }
  for (const FrameResult& frame : run.frames) {
    const traces::MatchedPose pose{frame.t_ns, frame.pose.T_world_body, frame.pose.T_world_body};
    run.ate->poses.push_back(pose);
  }
  run.ate->translation.rmse = 5;
  run.ate->size_ratio = 3;
  run.ate->located_rmse_m = 4.5;
  run.frames[2].map_restarts = 1;
  run.poses_left_out = 0;
  return run;
}

void expect_fits(const std::string& text, int width) {
  const std::vector<std::string> lines = lines_of(text);
  EXPECT_LE(lines.size() + 2, static_cast<std::size_t>(kScreenLines)) << text;
  for (const std::string& line : lines) EXPECT_LE(display_width(line), width) << line;
}

TEST(RunSummary, FitsAScreen) {
  for (const RunResult& run : {testing::example_run(), eventful_run(), RunResult()})
    for (const int width : {80, 120, 200}) expect_fits(run_summary(kHeading, run, width), width);
  const std::string deep = "leviosim: 5 frames of /" + std::string(300, 'x') + "/flight, 160x120";
  expect_fits(run_summary(deep, testing::example_run(), 80), 80);
  RunResult native = eventful_run();
  native.timed = false;
  expect_fits(run_summary(kHeading, native, 80), 80);
}

TEST(RunSummary, SaysAllThatMatters) {
  const std::string text = run_summary(kHeading, eventful_run(), 80);
  for (const char* part :
       {"verdict: map lost: the error is 83.3 % of the path",
        "time fits on average: 1 of 5 frames late", "frame time: mean 31.50, p99 60.00",
        "memory: L1 64.0 of 131.1 kB in optimiser iteration", "L2 794.5 of 1638.4 kB", "energy: ",
        "mJ per frame", "trajectory: ATE 5.000 m RMSE (4.500 m without guesses), 0.470 m worst",
        "SE3-aligned, 5 of 5 poses matched, completion 100.0 %, 5.40 m of path",
        "restarts of the map 1", "the scale is 3.00", "--tables all"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in:\n" << text;
}

/// A number without its first digits is another number.
TEST(RunSummary, NarrowScreensCutNoNumbers) {
  RunResult run = eventful_run();
  for (FrameResult& frame : run.frames) frame.end_ns = frame.start_ns + 1'336'000'000;
  ASSERT_NE(verdict(run).find("1336 ms"), std::string::npos) << verdict(run);
  for (const int width : {24, 40, 60, 80}) {
    std::string text = run_summary(kHeading, run, width);
    for (std::size_t at; (at = text.find("\n  ")) != std::string::npos;) text.replace(at, 3, " ");
    for (const std::string& part : {verdict(run), std::string("energy: "), std::string("worst ")})
      EXPECT_NE(text.find(part), std::string::npos) << part << " is not in:\n" << text;
  }
}

/// Data of one or two frames may well have a ground truth.
TEST(RunSummary, SaysWhyThereIsNoError) {
  RunResult run = testing::example_run();
  run.ate.reset();
  for (const std::size_t poses : {3u, 2u}) {
    run.trajectory.resize(poses);
    const std::string why = poses == 3 ? "no ground truth in the data" : "too few poses to align";
    for (const std::string& text : {run_summary(kHeading, run, 80), trajectory_summary(run)})
      EXPECT_NE(text.find(why), std::string::npos) << why << " is not in:\n" << text;
  }
}

/// A filter that diverges may be a galaxy away.
TEST(RunSummary, APathThatDivergedHasNoDigits) {
  RunResult run = eventful_run();
  run.trajectory.back().T_world_body.translation().x() = 2.34165364300e20;
  run.ate->translation.rmse = run.ate->translation.max = 1.2345e19;
  run.ate->located_rmse_m = 1.2345e19;
  run.ate->path_length_m = 5;
  const std::string screen = run_summary(kHeading, run, 80);
  for (const char* part : {"map lost: the path diverged", "trajectory: ATE diverged"})
    EXPECT_NE(screen.find(part), std::string::npos) << part << "\n" << screen;
  const std::string text = trajectory_summary(run);
  EXPECT_NE(text.find("poses, diverged\nATE: diverged"), std::string::npos) << text;
  EXPECT_EQ((screen + text).find("e+"), std::string::npos) << screen << text;
}

/// A memory of 128 KiB has room for 130.9 kB.
TEST(RunSummary, AMemoryIsFullAtItsSizeAndNotAtItsNominalOne) {
  RunResult run = testing::example_run();
  run.stages.front().memory.parallel = Bytes(130'900);
  const std::string text = run_summary(kHeading, run, 80);
  EXPECT_NE(text.find("L1 130.9 of 131.1 kB"), std::string::npos) << text;
  EXPECT_EQ(text.find("memory does not fit"), std::string::npos) << text;
}

/// Of the twenty stages those with the most cycles, in their order.
TEST(RunSummary, LeavesOutTheSmallestStages) {
  const std::string text = run_summary(kHeading, eventful_run(), 80);
  std::vector<std::string> shown;
  int left_out = 0;
  for (const std::string& line : lines_of(text)) {
    if (line.starts_with("optimiser iteration ")) shown.push_back(line.substr(20, 2));
    if (line.starts_with("… ")) left_out = std::stoi(line.substr(std::string("… ").size()));
  }
  ASSERT_GE(shown.size(), 5u) << text;
  EXPECT_EQ(shown.size() + static_cast<std::size_t>(left_out), 20u) << text;
  for (std::size_t i = 0; i < shown.size(); ++i)
    EXPECT_EQ(std::stoi(shown[i]), static_cast<int>(20 - shown.size() + i));
}

TEST(RunSummary, AllStagesStandWhereThereIsRoom) {
  const std::string text = run_summary(kHeading, testing::example_run(), 80);
  for (const char* name : {"\nfeature extraction", "\nEPnP RANSAC", "\noptimiser iteration"})
    EXPECT_NE(text.find(name), std::string::npos) << text;
  EXPECT_EQ(text.find("more with fewer cycles"), std::string::npos);
}

TEST(RunSummary, VerdictCountsFramesThatAreDroppedOrLate) {
  RunResult run = testing::example_run();
  run.frames[2].end_ns = run.frames[2].arrival_ns + 50'000'000;
  EXPECT_EQ(verdict(run),
            "verdict: fits: all 5 frames within 50 ms, worst 50 ms, memory fits, map good");
  run.camera = CameraRecord{};
  for (int i = 0; i < 8; ++i) run.camera->deliveries.push_back({});
  run.camera->deliveries[3].dropped = run.camera->deliveries[4].dropped = true;
  run.camera->deliveries[5].dropped = true;
  EXPECT_EQ(verdict(run),
            "verdict: fits on average: 3 of 8 frames dropped, a frame takes 29.5 ms on average of "
            "50 ms, worst 50 ms, memory fits, map good: of the 5 of 8 frames that were processed");
  EXPECT_EQ(verdict(RunResult()), "verdict: no frames");
}

TEST(RunSummary, OfANativeRunHasNoTiming) {
  RunResult run = testing::example_run();
  run.timed = false;
  const std::string text = run_summary(kHeading, run, 80);
  EXPECT_NE(text.find("verdict: map good"), std::string::npos) << text;
  EXPECT_EQ(text.find("kcycles"), std::string::npos);
  EXPECT_NE(text.find("frames: 5 (EPnP 2, 8-point 2, at rest or first of a map 1)"),
            std::string::npos);
}

TEST(RunSummary, LeavesRoomForOthers) {
  EXPECT_EQ(lines_of(run_summary(kHeading, eventful_run(), 80, 3)).size() + 3,
            lines_of(run_summary(kHeading, eventful_run(), 80)).size());
}

}  // namespace
}  // namespace leviosim::tools
