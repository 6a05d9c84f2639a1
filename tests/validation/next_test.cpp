// What the profile `next` promises on real frames: accuracy, and that it fits GAP9. Rendered
// flights take too long for tests; workload/ACCURACY.md has them, and next_robustness_test.cpp the
// standstill.
#include <gtest/gtest.h>

#include <algorithm>

#include "platform_models/loader/loader.h"
#include "tests/traces/test_folder.h"
#include "tools/app/result/summary.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/simulate.h"

namespace leviosim::tools {
namespace {

TEST(ValidationNext, IsAccurateOnRealFramesAndFitsTheChip) {
  const auto folder = traces::testing::recorded_data() / "euroc" / "MH_01_easy_t05_t20";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "no recorded flight: set LEVIOSIM_DATA to the folder that contains euroc/";
  RunRequest request;
  request.data = folder;
  request.profile = "next";
  request.platform = platform::resolve_platform("gap9");
  const RunResult run = simulate(request, [](const Progress&) {});

  ASSERT_TRUE(run.ate.has_value());
  EXPECT_EQ(run.ate->matched, 300U);
  EXPECT_LE(run.ate->translation.rmse, 0.06);
  for (const FrameResult& frame : run.frames)
    EXPECT_TRUE(frame.pose.T_world_body.matrix().allFinite()) << "frame " << frame.index;

  // An optimiser that is still busy at the start of a frame takes the next one. Three iterations of
  // a full window take 51 ms, a little more than a frame.
  EXPECT_LT(run.optimiser_late, 170);
  double work_ms = 0;
  for (const StageResult& stage : run.stages)
    work_ms += milliseconds(static_cast<double>(stage.parallel.count()), clock_of(run, stage));
  EXPECT_LT(work_ms / 300, 50) << "front end and optimiser, as if one waited for the other";
  EXPECT_EQ(frames_that_waited(run).frames, 0);
  std::int64_t frames = 0, tracked = 0, latency_ns = 0;
  for (const Scenario& scenario : scenarios(run)) {
    frames += scenario.frames;
    latency_ns += scenario.latency_ns;
    if (scenario.key == "tracked" || scenario.key == "tracked_keyframe") tracked += scenario.frames;
  }
  EXPECT_EQ(frames, 300);
  EXPECT_GT(tracked, 200);
  EXPECT_LT(latency_ns / frames, 50'000'000);
  for (const StageResult& stage : run.stages)
    EXPECT_LE(stage.memory.parallel, stage.on_controller ? run.l2_size : run.l1_size) << stage.name;
}

}  // namespace
}  // namespace leviosim::tools
