#include "workload/vio/odometry/back_end.h"

#include <gtest/gtest.h>

#include "optimiser_scene.h"
#include "workload/vio/profile.h"

namespace leviosim::vio::test {
namespace {

using work::Native;

/// What the graph holds after the back end has optimised once and published.
struct Published {
  explicit Published(const char* profile_name) {
    Profile profile = profile_named(profile_name, 1);
    profile.optimiser.visual = scene.options.visual;
    MapStatus map;
    map.aligned = true;
    BackEnd<Native> back_end(profile, Rig{}, scene.fc, scene.graph, map);
    EXPECT_TRUE(back_end.begin());
    EXPECT_TRUE(back_end.optimise().accepted);
    back_end.publish();
  }

  KeyframeState<Native> keyframe(int k) const {
    return scene.graph.keyframe(scene.graph.keyframe_slot(k));
  }
  /// How far a keyframe's velocity is from that at which it was reached, m/s.
  float contradiction(int k) const {
    const Vec3<Native> moved = keyframe(k).T_world_camera.t - keyframe(k - 1).T_world_camera.t;
    const float per_second = 1.0f / static_cast<float>(scene.scene.interval_s);
    return norm(keyframe(k).velocity - moved * per_second);
  }

  OptimiserScene<Native> scene{{.velocity_noise = 0.5}};
};

TEST(BackEnd, WithoutAnImuVelocitiesFollowTheOptimisedPositions) {
  for (const char* profile : {"levio-no-imu", "levio-no-imu-no-epnp"}) {
    const Published published(profile);
    for (int k = 1; k < 8; ++k) EXPECT_LT(published.contradiction(k), 1e-4f) << profile << ' ' << k;
  }
}

TEST(BackEnd, WithAnImuVelocitiesAreThoseAtTheKeyframe) {
  // The motion is accelerated: the mean velocity of an interval is not that at its end.
  const Published published("levio");
  float largest = 0;
  for (int k = 1; k < 8; ++k) largest = std::max(largest, published.contradiction(k));
  EXPECT_GT(largest, 0.05f);
}

}  // namespace
}  // namespace leviosim::vio::test
