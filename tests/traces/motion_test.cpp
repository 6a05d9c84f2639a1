#include "traces/synthesis/motion.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "traces/datasets/euroc_sensors.h"
#include "traces/synthesis/world.h"

namespace leviosim::traces {
namespace {

constexpr std::uint64_t kSeeds = 10;

TEST(HandHeldFlight, DerivativesAreThoseOfThePath) {
  constexpr double kStep = 1e-5;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const HandHeldFlight motion(seed);
    for (double t = 0.513; t < 20; t += 0.371) {
      const MotionState before = motion.at(t - kStep);
      const MotionState now = motion.at(t);
      const MotionState after = motion.at(t + kStep);
      const Eigen::Vector3d velocity =
          (after.T_world_body.translation() - before.T_world_body.translation()) / (2 * kStep);
      const Eigen::Vector3d acceleration = (after.velocity - before.velocity) / (2 * kStep);
      const Eigen::AngleAxisd turn(before.T_world_body.linear().transpose() *
                                   after.T_world_body.linear());
      const Eigen::Vector3d angular_velocity = turn.angle() * turn.axis() / (2 * kStep);
      EXPECT_LT((velocity - now.velocity).norm(), 1e-8) << seed << " " << t;
      EXPECT_LT((acceleration - now.acceleration).norm(), 1e-8) << seed << " " << t;
      EXPECT_LT((angular_velocity - now.angular_velocity).norm(), 1e-7) << seed << " " << t;
    }
  }
}

TEST(HandHeldFlight, RestsForOneSecond) {
  const HandHeldFlight motion(3);
  const Eigen::Matrix4d start = motion.at(-0.05).T_world_body.matrix();
  for (const double t : {0.0, 0.5, 1.0}) {
    EXPECT_EQ(motion.at(t).T_world_body.matrix(), start);
    EXPECT_EQ(motion.at(t).velocity.norm(), 0);
    EXPECT_EQ(motion.at(t).acceleration.norm(), 0);
    EXPECT_EQ(motion.at(t).angular_velocity.norm(), 0);
  }
  EXPECT_GT(motion.at(3).velocity.norm(), 0.05);
}

TEST(HandHeldFlight, SpeedsRoomAndPathAreThePromisedOnes) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const HandHeldFlight motion(seed);
    double path = 0, fastest = 0, fastest_turn = 0;
    constexpr double kStep = 0.01;
    for (double t = 0; t < 20; t += kStep) {
      const MotionState state = motion.at(t);
      const Eigen::Vector3d p = state.T_world_body.translation();
      ASSERT_LE(std::abs(p.x()), 1.15);
      ASSERT_LE(std::abs(p.y()), 0.8);
      ASSERT_LE(std::abs(p.z() - 1.6), 0.4 + 1e-12);
      path += state.velocity.norm() * kStep;
      fastest = std::max(fastest, state.velocity.norm());
      fastest_turn = std::max(fastest_turn, state.angular_velocity.norm());
    }
    EXPECT_GT(path, 9);
    EXPECT_LT(path, 13);
    EXPECT_GT(fastest, 0.8);
    EXPECT_LT(fastest, 1.31);
    EXPECT_GT(fastest_turn * 57.3, 40);
    EXPECT_LT(fastest_turn * 57.3, 60);
  }
}

TEST(HandHeldFlight, TheCameraLooksAtStructureAtUsefulDistance) {
  const World room = make_room(1, 0.05, 1);
  const Eigen::Isometry3d T_body_camera = euroc_cam0().T_body_camera;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const HandHeldFlight motion(seed);
    for (double t = 0; t < 20; t += 0.1) {
      const Eigen::Isometry3d pose = motion.at(t).T_world_body * T_body_camera;
      const Eigen::Vector3f origin = pose.translation().cast<float>();
      const Eigen::Vector3f ahead = pose.linear().col(2).cast<float>();
      const float distance = room.cast(origin, ahead).reach;
      ASSERT_GT(distance, 1.4f);
      ASSERT_LT(distance, 6.3f);
    }
  }
}

}  // namespace
}  // namespace leviosim::traces
