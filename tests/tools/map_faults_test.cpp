// What a run warns of at its end, each at its limit.
#include "tools/app/result/map_faults.h"

#include <gtest/gtest.h>

#include "tests/tools/example_run.h"
#include "tools/app/report/tables.h"

namespace leviosim::tools {
namespace {

/// Poses on a line of 10 m; the estimate's is `scale` times as long.
RunResult with_scale(double scale) {
  RunResult run = testing::example_run();
  run.ate->path_length_m = 10;
  for (int i = 0; i <= 10; ++i) {
    traces::MatchedPose pose;
    pose.truth.translation().x() = i;
    pose.estimate.translation().x() = scale * i;
    run.ate->poses.push_back(pose);
  }
  return run;
}

RunResult with_error(double share, double path_m = 10) {
  RunResult run = testing::example_run();
  run.ate->path_length_m = path_m;
  run.ate->translation.rmse = share * path_m;
  return run;
}

/// Frames of 50 ms, of which `kept` in a row have no pose of their own.
RunResult with_kept(int kept) {
  RunResult run = testing::example_run();
  run.frames.clear();
  for (int i = 0; i < 100; ++i)
    run.frames.push_back(testing::frame(
        i, i >= 10 && i < 10 + kept ? PoseSource::Kept : PoseSource::Epnp, false, 1'000'000));
  return run;
}

using Texts = std::vector<std::string>;

TEST(MapFaults, AGoodMapHasNone) {
  EXPECT_EQ(map_faults(testing::example_run()), Texts());
  EXPECT_EQ(map_faults(RunResult()), Texts());
  EXPECT_EQ(map_warning(testing::example_run()), "");
}

TEST(MapFaults, AnErrorAboveAShareOfThePath) {
  EXPECT_EQ(map_faults(with_error(0.099)), Texts());
  EXPECT_EQ(map_faults(with_error(0.213)), (Texts{"the error is 21.3 % of the path"}));
  EXPECT_EQ(map_faults(with_error(5, 0.9)), Texts()) << "a path too short to tell";
}

TEST(MapFaults, AScaleThatIsOffEitherWay) {
  for (const double right : {0.81, 1.0, 1.24}) EXPECT_EQ(map_faults(with_scale(right)), Texts());
  EXPECT_EQ(map_faults(with_scale(1.26)), (Texts{"the scale is 1.26"}));
  EXPECT_EQ(map_faults(with_scale(0.25)), (Texts{"the scale is 0.25"}));
}

TEST(MapFaults, APoseThatIsKeptForSeconds) {
  EXPECT_EQ(map_faults(with_kept(40)), Texts());  // 2 s after the last pose
  EXPECT_EQ(map_faults(with_kept(41)).size(), 1u);
  EXPECT_EQ(map_faults(with_kept(48)), (Texts{"the pose was kept for 2.4 s"}));
  RunResult apart = with_kept(60);
  apart.frames[40].source = PoseSource::Tracked;
  EXPECT_EQ(map_faults(apart), Texts());
}

TEST(MapFaults, AreAllNamedInOneWarningAtTheEnd) {
  RunResult run = with_kept(60);
  run.ate->translation.rmse = 2.7;  // of 5.4 m
  run.poses_left_out = 3;
  EXPECT_EQ(map_warning(run),
            "warning: the map is wrong: the error is 50.0 % of the path, the pose was kept for 3.0 "
            "s, 3 poses are NaN\n");
  const std::string text = report(run);
  EXPECT_TRUE(text.ends_with(map_warning(run)));
}

}  // namespace
}  // namespace leviosim::tools
