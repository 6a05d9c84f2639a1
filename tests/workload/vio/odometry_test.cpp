// What the odometry makes of a profile before it runs it.
#include "workload/vio/odometry/odometry.h"
#include "workload/vio/profile.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace leviosim::vio {
namespace {

Rig euroc_rig(int factor) {
  Rig rig{};
  const auto f = static_cast<float>(factor);
  rig.camera = {458.654f / f, 457.296f / f, 311.215f / f, 248.375f / f};
  rig.width = 640 / factor;
  rig.height = 480 / factor;
  return rig;
}

TEST(Odometry, ItsOptimiserHasTheReleasesCameraAtTheReleasesSize) {
  const ReprojectionOptions release;
  const ReprojectionOptions fitted =
      fitted_to(euroc_rig(4), profile_named("levio", 1)).optimiser.visual;
  EXPECT_EQ(fitted.camera.fx, release.camera.fx);
  EXPECT_EQ(fitted.camera.fy, release.camera.fy);
  EXPECT_EQ(fitted.camera.cx, release.camera.cx);
  EXPECT_EQ(fitted.camera.cy, release.camera.cy);
  EXPECT_EQ(fitted.lost_px, release.lost_px);
}

TEST(Odometry, ItsOptimiserHasTheCameraOfLargerImages) {
  const ReprojectionOptions fitted =
      fitted_to(euroc_rig(2), profile_named("levio", 1)).optimiser.visual;
  EXPECT_EQ(fitted.camera.fx, 229.33f);
  EXPECT_EQ(fitted.camera.fy, 228.65f);
  EXPECT_EQ(fitted.camera.cx, 155.61f);
  EXPECT_EQ(fitted.camera.cy, 124.19f);
  EXPECT_EQ(fitted.lost_px, 80);
}

/// In the order in which a frame passes them; those of the controller end with a star.
std::vector<std::string> stages_of(const Profile& profile) {
  std::vector<std::string> names;
  for (const StageName& stage : stage_names(profile))
    names.push_back(std::string(stage.name) + (stage.on_controller ? "*" : ""));
  return names;
}

using Stages = std::vector<std::string>;

TEST(Odometry, StagesOfLevioAreThoseOfThePaper) {
  const Stages expected = {"IMU pre-integration", "feature extraction", "world matching",
                           "EPnP RANSAC",         "frame matching",     "8-point RANSAC",
                           "keyframe selection",  "triangulation",      "optimiser update*",
                           "optimiser iteration*"};
  EXPECT_EQ(stages_of(profile_named("levio", 1)), expected);
  EXPECT_EQ(stages_of(profile_named("levio-no-imu", 1)), expected);
  EXPECT_EQ(stages_of(profile_named("levio-no-imu-no-epnp", 1)), expected);
}

TEST(Odometry, LevioHasNoStagesOfNextWhateverItsOptionsSay) {
  Profile profile = profile_named("levio", 1);
  const Stages before = stages_of(profile);
  profile.patches.enabled = profile.alignment.enabled = profile.loop.enabled = true;
  EXPECT_EQ(stages_of(profile), before);
}

TEST(Odometry, NextAddsItsStagesWhereAFramePassesThem) {
  EXPECT_EQ(stages_of(profile_named("next", 1)),
            (Stages{"IMU pre-integration", "feature extraction", "guided matching",
                    "world matching", "EPnP RANSAC", "pose refinement", "frame matching",
                    "patch alignment", "8-point RANSAC", "keyframe selection", "triangulation",
                    "initialisation*", "optimiser update*", "optimiser iteration*"}));
}

TEST(Odometry, LoopClosureIsTheLastOfTheCluster) {
  EXPECT_EQ(stages_of(profile_named("next-loop", 1)),
            (Stages{"IMU pre-integration", "feature extraction", "guided matching",
                    "world matching", "EPnP RANSAC", "pose refinement", "frame matching",
                    "patch alignment", "8-point RANSAC", "keyframe selection", "triangulation",
                    "place recognition", "loop verification", "loop correction", "initialisation*",
                    "optimiser update*", "optimiser iteration*"}));
}

TEST(Odometry, NextHasNoStagesOfWhatIsOff) {
  Profile profile = profile_named("next-loop", 1);
  profile.patches.enabled = profile.alignment.enabled = false;
  EXPECT_EQ(
      stages_of(profile),
      (Stages{"IMU pre-integration", "feature extraction", "guided matching", "world matching",
              "EPnP RANSAC", "pose refinement", "frame matching", "8-point RANSAC",
              "keyframe selection", "triangulation", "place recognition", "loop verification",
              "loop correction", "optimiser update*", "optimiser iteration*"}));
}

}  // namespace
}  // namespace leviosim::vio
