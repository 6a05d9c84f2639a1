// What the odometry makes of a profile before it runs it.
#include "workload/vio/odometry/odometry.h"
#include "workload/vio/profile.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace leviosim::vio
