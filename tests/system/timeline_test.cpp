// run --timeline and replay --timeline as users meet them, and the timelines of whole flights.
#include <gtest/gtest.h>

#include "platform_models/loader/variants.h"
#include "tests/support/program_suite.h"
#include "tests/tools/timeline_checks.h"
#include "tools/app/record/statistics.h"
#include "tools/app/run/simulate.h"
#include "tools/app/timeline/perfetto_timeline.h"
#include "tools/app/timeline/requested_timeline.h"
#include "tools/app/timeline/timeline_collector.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::expect_sums_of;
using testing::ProgramResult;
using tests::PerfettoEvent;
using tests::PerfettoTrace;

/// Three seconds of flight, recorded once with a timeline.
class TimelineOfFlight : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("timeline");
    traces::write_synthetic_flight(*folder_ / "flight", {.duration_s = 3, .texel_m = 0.02});
    const ProgramResult result =
        program({"run", "--platform", "gap9", "--data", path("flight"), "--out", path("run"),
                 "--record", "--quiet", "--timeline", path("run.pftrace")});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("timeline: "), std::string::npos) << result.out;
  }
  static std::string text(const std::string& name) { return base::read_text_file(*folder_ / name); }
  static RunRequest request(const std::string& platform,
                            const std::vector<std::string>& overrides = {}) {
    RunRequest request;
    request.data = path("flight");
    request.platform = platform::resolve_platform(platform, overrides);
    request.cores = request.platform.config.cluster.workers;
    return request;
  }
  /// Runs it, and holds its timeline against it.
  static PerfettoTrace timeline_of(RunRequest request, RunResult& run) {
    std::string bytes;
    PerfettoTimeline timeline(request.platform.config,
                              {.cores = request.cores, .is_closed = request.camera.has_value()},
                              [&](std::string_view piece) { bytes += piece; });
    request.observer = &timeline;
    run = simulate(request, [](const Progress&) {});
    timeline.finish(run);
    EXPECT_LE(bytes.size(), 50'000 * run.frames.size());
    PerfettoTrace trace(bytes);
    expect_sums_of(trace, run);
    return trace;
  }
};

TEST_F(TimelineOfFlight, AddsUpToTheStageTable) {
  RunResult run;
  const PerfettoTrace trace = timeline_of(request("gap9"), run);
  EXPECT_GT(run.optimiser_published, 0);
  EXPECT_GT(trace.on("power without controller").size(), run.frames.size());
  for (const PerfettoEvent& power : trace.on("power without controller")) {
    EXPECT_GT(power.value, 1);
    EXPECT_LT(power.value, 200);
  }
  for (const char* wait : {"FPU", "divider", "L1 banks", "code"})
    EXPECT_TRUE(std::any_of(trace.events().begin(), trace.events().end(),
                            [&](const PerfettoEvent& e) { return e.number(wait) > 0; }))
        << wait;
}

TEST_F(TimelineOfFlight, WorksWithOneCoreAndWithoutACluster) {
  RunRequest one = request("gap9");
  one.cores = 1;
  RunResult run;
  timeline_of(one, run);
  for (const char* chip : {"cortex-m7-h7a3", "arm1176"}) timeline_of(request(chip), run);
}

TEST_F(TimelineOfFlight, WorksOnAcceleratorsAndForTheOtherProfile) {
  RunResult run;
  timeline_of(request("gap9-hamming"), run);
  RunRequest next = request("gap9");
  next.profile = "next";
  timeline_of(next, run);
}

TEST_F(TimelineOfFlight, OfAClosedLoopShowsEveryFrameOfTheCamera) {
  RunRequest slow = request("gap9", {"cluster.clock=90MHz", "controller.clock=60MHz"});
  slow.camera = CameraRequest{};
  RunResult run;
  const PerfettoTrace trace = timeline_of(slow, run);
  std::size_t dropped = 0;
  for (const PerfettoEvent& event : trace.on("camera")) dropped += event.number("dropped") == 1;
  EXPECT_GT(dropped, 0u);
  EXPECT_EQ(dropped + run.frames.size(), 60u);
  EXPECT_EQ(trace.on("deadlines").size(), 60u);
}

TEST_F(TimelineOfFlight, ChangesNothingElse) {
  ASSERT_EQ(program({"run", "--platform", "gap9", "--data", path("flight"), "--out",
                     path("without"), "--record", "--quiet"})
                .status,
            0);
  auto with = traces::testing::contents(*folder_ / "run");
  auto without = traces::testing::contents(*folder_ / "without");
  with.erase("manifest.json");
  without.erase("manifest.json");
  EXPECT_EQ(with, without);
}

TEST_F(TimelineOfFlight, AReplayOnTheSameChipGivesTheSameBytes) {
  const ProgramResult result = program({"replay", path("run"), "--out", path("again"), "--quiet",
                                        "--timeline", path("again.pftrace")});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(text("run.pftrace"), text("again.pftrace"));
  EXPECT_LE(text("run.pftrace").size(), 60u * 50'000);
}

TEST_F(TimelineOfFlight, TakesTheFramesThatWereAskedFor) {
  const ProgramResult result =
      program({"replay", path("run"), "--out", path("some"), "--quiet", "--timeline",
               path("some.pftrace"), "--timeline-frames", "10:12"});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string bytes = text("some.pftrace");
  EXPECT_EQ(PerfettoTrace(bytes).on("camera").size(), 2u);
}

TEST_F(TimelineOfFlight, APictureHasTwoFramesAndSaysWhich) {
  const ProgramResult result = program(
      {"replay", path("run"), "--out", path("drawn"), "--quiet", "--timeline", path("drawn.svg")});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("timeline of frames 29:31 (--timeline-frames"), std::string::npos)
      << result.out;
}

TEST_F(TimelineOfFlight, NamesOfOtherFormatsAreRefused) {
  for (const char* name : {"x.json", "x.html"})
    testing::expect_refused(
        program({"replay", path("run"), "--out", path("no"), "--timeline", path(name)}),
        {name, ".svg", ".pftrace"});
  EXPECT_FALSE(fs::exists(*folder_ / "no"));
}

TEST_F(TimelineOfFlight, LeavesJsonOnStdoutAsItIs) {
  const ProgramResult result =
      program({"replay", path("run"), "--out", path("json"), "--quiet", "--json", "--timeline",
               path("json.pftrace"), "--timeline-frames", "0:1"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, text("json/run.json"));
  EXPECT_TRUE(fs::exists(path("json.pftrace")));
}

TEST_F(TimelineOfFlight, RefusesWhatItCannotDo) {
  const auto replay = [](const std::vector<std::string>& more) {
    std::vector<std::string> words{"replay", path("run"), "--out", path("none"), "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return program(words);
  };
  const std::string file = path("none.pftrace");
  expect_refused(replay({"--timeline", file, "--timeline-frames", "5"}),
                 {"--timeline-frames", "'5'", "A:B"});
  expect_refused(replay({"--timeline", file, "--timeline-frames", "30:61"}),
                 {"--timeline-frames", "60 frames", "0:60"});
  expect_refused(replay({"--timeline-frames", "3:4"}), {"--timeline-frames", "--timeline"});
  expect_refused(replay({"--timeline", path("none/file")}), {"--timeline", "--out", "beside"});
  expect_refused(replay({"--timeline", path("run.pftrace")}), {"--timeline", "--force"});
  std::ofstream(path("mine.txt")) << "mine";
  expect_refused(replay({"--timeline", path("mine.txt"), "--force"}),
                 {"--timeline", "not a file that leviosim wrote"});
  EXPECT_EQ(text("mine.txt"), "mine");
  expect_refused(program({"run", "--native", "--data", path("flight"), "--out", path("none"),
                          "--timeline", file}),
                 {"--native", "--timeline"});
  EXPECT_FALSE(fs::exists(file));
  EXPECT_FALSE(fs::exists(path("none")));
}

}  // namespace
}  // namespace leviosim::tools
