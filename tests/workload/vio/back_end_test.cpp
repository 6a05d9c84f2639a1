#include "workload/vio/odometry/back_end.h"

#include <gtest/gtest.h>

#include "tests/workload/graph/optimiser_scene.h"
#include "workload/graph/carried_poses.h"
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

/// A keyframe that was added while the optimiser worked on a snapshot without it, with the velocity
/// to which the IMU carries the last one's as it was.
struct Overtaken {
  Overtaken(bool aligned, int few) {
    Profile profile = profile_named("next", 1);
    profile.optimiser.visual = scene.options.visual;
    profile.alignment.few_keyframes = few;
    profile.alignment.max_prior_deviation = profile.alignment.max_distance = 1e6f;
    profile.alignment.min_explained = 0;
    map.aligned = aligned;
    BackEnd<Native> back_end(profile, Rig{}, scene.fc, scene.graph, map);
    EXPECT_TRUE(back_end.begin());
    before = keyframe(6);
    interval.reset(scene.graph.bias());
    integrate<Native>(scene.motion, scene.time(6), scene.time(7), 40, interval, {});
    added = carried(before);
    scene.graph.add_keyframe(added, interval.record());
    for (int i = 0; i < 20; ++i) back_end.optimise();
    back_end.publish();
  }

  KeyframeState<Native> keyframe(int k) const {
    return scene.graph.keyframe(scene.graph.keyframe_slot(k));
  }
  KeyframeState<Native> carried(const KeyframeState<Native>& from) const {
    return carried_on<Native>(from, interval.corrected(scene.graph.bias()), scene.graph.gravity(),
                              {0, 0, 0});
  }

  OptimiserScene<Native> scene{{.keyframes = 7, .velocity_noise = 0.5}};
  OwnedInterval<Native> interval;
  MapStatus map;
  KeyframeState<Native> before, added;
};

TEST(BackEnd, NewerKeyframesHaveTheCorrectedVelocity) {
  for (const bool aligned : {true, false}) {
    const Overtaken late(aligned, 4);
    EXPECT_GT(norm(late.keyframe(6).velocity - late.before.velocity), 0.1f) << aligned;
    EXPECT_LT(norm(late.keyframe(7).velocity - late.carried(late.keyframe(6)).velocity), 1e-4f)
        << aligned;
  }
}

/// Images have placed a keyframe relative to the last one; before the alignment only the IMU has.
TEST(BackEnd, NewerKeyframesKeepTheirPlaceOrAreCarriedAnew) {
  for (const bool aligned : {true, false}) {
    const Overtaken late(aligned, 4);
    const Pose<Native> followed = late.keyframe(6).T_world_camera *
                                  inverse(late.before.T_world_camera) * late.added.T_world_camera;
    const Vec3<Native> carried = late.carried(late.keyframe(6)).T_world_camera.t;
    EXPECT_GT(norm(carried - followed.t), 0.01f) << aligned;
    EXPECT_LT(norm(late.keyframe(7).T_world_camera.t - (aligned ? followed.t : carried)), 1e-4f)
        << aligned;
  }
}

/// With few keyframes, landmarks are held to about the same distance, and the scale may be any.
TEST(BackEnd, AnAlignmentOfFewKeyframesIsNoneToReport) {
  EXPECT_FALSE(Overtaken(false, 7).map.converged);
  EXPECT_TRUE(Overtaken(false, 6).map.converged);
}

}  // namespace
}  // namespace leviosim::vio::test
