// Means of stages on either path, and weighed as the paper's frames are.
#include "tools/app/validation/frame_log.h"
#include "tools/app/validation/paths.h"

#include <gtest/gtest.h>

#include "tests/validation/example_log.h"

namespace leviosim::tools {
namespace {

using testing::example_log;
namespace s = vio::stages;

StageOnPaths stage_of(const FrameLog& log, std::string_view key) {
  for (const StageOnPaths& stage : stages_on_paths(log))
    if (stage.key == key) return stage;
  ADD_FAILURE() << key;
  return {};
}

/// Of the example, one frame ran EPnP alone, and two the 8-point algorithm.
TEST(PathWeights, MeansOfEitherPathCountAsInThePaper) {
  const StageOnPaths extraction = stage_of(example_log(), "feature_extraction");
  EXPECT_EQ(extraction.parallel.epnp, 11'000);
  EXPECT_EQ(extraction.parallel.eight_point, 10'000);
  EXPECT_NEAR(extraction.parallel.weighed.value(), 0.427 * 11'000 + 0.573 * 10'000, 1e-9);
  EXPECT_NEAR(extraction.single.weighed.value(), 7 * *extraction.parallel.weighed, 1e-9);
}

TEST(PathWeights, AStageOfSomeFramesWeighsLess) {
  FrameLog log = example_log();
  testing::feed(log, {PoseSource::Epnp, true, 300, 80, {{s::kEpnp, 1}, {s::kTriangulation, 900}}});
  const StageOnPaths triangulation = stage_of(log, "triangulation");
  EXPECT_EQ(triangulation.parallel.epnp, 900);
  EXPECT_EQ(triangulation.parallel.eight_point, 700);
  // One of two frames on either path is a keyframe, so both weigh half of what they else would.
  EXPECT_NEAR(triangulation.parallel.weighed.value(), 0.427 * 900 + 0.573 * 700, 1e-9);
  testing::feed(log, {PoseSource::Epnp, false, 300, 80, {{s::kEpnp, 1}}});
  testing::feed(log, {PoseSource::Epnp, false, 300, 80, {{s::kEpnp, 1}}});
  // Now one of four on the path of EPnP.
  EXPECT_NEAR(stage_of(log, "triangulation").parallel.weighed.value(),
              (0.427 / 4 * 900 + 0.573 / 2 * 700) / (0.427 / 4 + 0.573 / 2), 1e-9);
}

TEST(PathWeights, NothingIsWeighedThatOnePathLacks) {
  const StageOnPaths triangulation = stage_of(example_log(), "triangulation");
  EXPECT_FALSE(triangulation.parallel.epnp.has_value());
  EXPECT_EQ(triangulation.parallel.eight_point, 700);
  EXPECT_FALSE(triangulation.parallel.weighed.has_value());
}

TEST(PathWeights, BothRansacsAreNoStagesOfEitherPath) {
  for (const StageOnPaths& stage : stages_on_paths(example_log()))
    EXPECT_TRUE(stage.key != "epnp_ransac" && stage.key != "eight_point_ransac") << stage.key;
}

}  // namespace
}  // namespace leviosim::tools
