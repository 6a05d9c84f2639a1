#include <gtest/gtest.h>

#include <cstring>

#include "pose_graph_fixture.h"
#include "tests/workload/graph/optimiser_scene.h"
#include "workload/graph/window.h"

namespace leviosim::vio::test {
namespace {

using work::Counting;
using work::Native;

/// A graph of four keyframes at x = 0, 1, 2, 3 with some landmarks, and a window for it.
struct Snapshots : ::testing::Test {
  Snapshots() : f(capacity), window(f.memory, capacity) {
    for (int k = 0; k < 4; ++k) {
      keyframes[k] = f.add_keyframe(static_cast<float>(k));
      if (k == 0)
        for (int i = 0; i < 4; ++i) f.add_landmark(static_cast<float>(i));
      for (int i = 0; i < 4; ++i)
        if (k <= i) f.observe(keyframes[k], i, 10 * i + k, 100 + k);  // landmark i: keyframes 0…i
    }
    snapshot();
  }
  void snapshot() { take_snapshot<Native>(f.graph, ImuNoise{}, f.memory, window); }
  int place_of(int landmark) const {
    for (int i = 0; i < window.landmarks; ++i)
      if (window.landmark_slots[i] == landmark) return i;
    return -1;
  }

  const GraphCapacity capacity{4, 6, 30};
  GraphFixture<Native> f;
  Window<Native> window;
  int keyframes[4];
};

TEST_F(Snapshots, TakesKeyframesFromTheOldestOn) {
  f.add_keyframe(4);  // the one at x = 0 leaves
  snapshot();
  ASSERT_EQ(window.keyframes, 4);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(window.state.pose(k).t.x, static_cast<float>(k + 1));
    EXPECT_EQ(window.keyframe_ids[k], k + 1);
  }
  EXPECT_EQ(window.anchor.T_world_camera.t.x, 1.0f);
  EXPECT_EQ(window.gravity.y, 9.81f);
}

TEST_F(Snapshots, LeavesOutLandmarksSeenOnce) {
  EXPECT_EQ(window.landmarks, 3);
  EXPECT_EQ(place_of(0), -1);
  for (int landmark = 1; landmark < 4; ++landmark)
    EXPECT_EQ(window.observation_numbers[place_of(landmark)], landmark + 1);
}

TEST_F(Snapshots, SortsObservationsByLandmarkAndKeyframe) {
  for (int landmark = 1; landmark < 4; ++landmark) {
    const int i = place_of(landmark);
    EXPECT_EQ(window.state.points[3 * i], static_cast<float>(landmark));
    for (int j = 0; j <= landmark; ++j) {
      const int o = window.first_observations[i] + j;
      EXPECT_EQ(window.observation_keyframes[o], j);
      EXPECT_EQ(window.observation_u[o], 10 * landmark + j);
      EXPECT_EQ(window.observation_v[o], 100 + j);
    }
  }
}

TEST_F(Snapshots, IgnoresObservationsOfTheLandmarkBeforeInTheSlot) {
  f.graph.age_landmarks();
  f.graph.age_landmarks();
  while (f.add_landmark(50) != 2) {
  }
  f.observe(keyframes[3], 2, 1, 1);
  snapshot();
  EXPECT_EQ(place_of(2), -1) << "the new landmark in slot 2 has been seen once";
}

TEST_F(Snapshots, KeepsOneObservationForEachKeyframe) {
  f.observe(keyframes[3], 3, 1, 1);  // a second one of the same keyframe
  f.observe(keyframes[1], 3, 1, 1);  // out of order
  snapshot();
  EXPECT_EQ(window.observation_numbers[place_of(3)], 4);
}

TEST_F(Snapshots, PublishWritesKeyframesAndLandmarks) {
  KeyframeState<Native> state = window.state.keyframe(2);
  state.T_world_camera.t.y = 7;
  state.velocity.z = 3;
  window.state.set_keyframe(2, state);
  window.state.points[3 * place_of(3) + 1] = 9;
  publish<Native>(window, f.graph);
  EXPECT_EQ(f.graph.keyframe(keyframes[2]).T_world_camera.t.y, 7.0f);
  EXPECT_EQ(f.graph.keyframe(keyframes[2]).velocity.z, 3.0f);
  EXPECT_EQ(f.graph.point(3).y, 9.0f);
}

TEST_F(Snapshots, PublishSparesSlotsReusedMeanwhile) {
  for (int i = 0; i < 3 * window.landmarks; ++i) window.state.points[i] = -1;
  for (int k = 0; k < 4; ++k) window.state.set_keyframe(k, {Pose<Native>::identity(), {0, 0, -1}});
  const int newcomer = f.add_keyframe(77);  // takes the slot of the oldest
  ASSERT_EQ(newcomer, keyframes[0]);
  while (f.add_landmark(50) != 1) {
  }
  publish<Native>(window, f.graph);
  EXPECT_EQ(f.graph.keyframe(newcomer).T_world_camera.t.x, 77.0f);
  EXPECT_EQ(f.graph.keyframe(newcomer).velocity.z, 0.0f);
  EXPECT_EQ(f.graph.keyframe(keyframes[1]).velocity.z, -1.0f);
  EXPECT_EQ(f.point_x(1), 50.0f);
  EXPECT_EQ(f.point_x(3), -1.0f);
}

TEST_F(Snapshots, PublishWritesBiasesOnlyIfEstimated) {
  const ImuBias<Native> at_rest{{1, 2, 3}, {0, 0, 0}};
  f.graph.set_bias(at_rest);  // the front end saw the vehicle stand still
  publish<Native>(window, f.graph);
  EXPECT_EQ(f.graph.bias().gyro.y, 2.0f);
  estimate_biases<Native>(window, ImuNoise{}, {});
  publish<Native>(window, f.graph);
  EXPECT_EQ(f.graph.bias().gyro.y, 0.0f);
}

TEST_F(Snapshots, PublishRetiresLostLandmarks) {
  window.lost[place_of(2)] = 1;
  publish<Native>(window, f.graph);
  EXPECT_EQ(f.age(2), kOldestAge);
  EXPECT_LT(f.age(3), kOldestAge);
  snapshot();
  EXPECT_EQ(place_of(2), -1) << "its observations are void";
  EXPECT_NE(place_of(3), -1);
  f.graph.age_landmarks();
  EXPECT_EQ(f.add_landmark(50), 4);
  EXPECT_EQ(f.add_landmark(50), 5);
  EXPECT_EQ(f.add_landmark(50), 2) << "after those that were never used its slot is next";
}

TEST(SnapshotIntervals, WhatLeavesTheWindowEntersThePriorOnce) {
  const Motion motion;
  GraphFixture<Native> f(GraphCapacity{3, 6, 30});
  Window<Native> window(f.memory, GraphCapacity{3, 6, 30});
  const OwnedInterval<Native> interval;
  const ImuNoise noise;
  const float per_interval = 0.2f / (noise.gyro * noise.gyro);
  interval.reset(ImuBias<Native>::zero());
  for (int k = 0; k < 6; ++k) {
    if (k > 0)
      integrate<Native>(motion, 0.2 * (k - 1), 0.2 * k, 40, interval, ImuBias<Native>::zero());
    f.graph.add_keyframe(motion.state<Native>(0.2 * k), interval.record());
    for (int again = 0; again < 2; ++again) {  // a snapshot is taken for every frame
      absorb_departed_intervals<Native>(window, f.graph, noise, {});
      take_snapshot<Native>(f.graph, noise, f.memory, window);
    }
    // Of k intervals so far, two are in a window of three keyframes.
    const float expected = per_interval * static_cast<float>(std::max(0, k - 2));
    EXPECT_NEAR(f.graph.bias_prior().gyro_information, expected, 0.01f * expected + 0.1f) << k;
  }
}

TEST(SnapshotIntervals, HoldTheFactorOfCovarianceWithGravityNoise) {
  const Motion motion;
  const OwnedInterval<Native> interval;
  integrate<Native>(motion, 0, 0.3, 60, interval, ImuBias<Native>::zero());
  Eigen::MatrixXd covariance(9, 9);
  for (int r = 0; r < 9; ++r)
    for (int c = 0; c < 9; ++c)
      covariance(r, c) = static_cast<double>(r / 3 >= c / 3 ? interval.covariance()(r, c)
                                                            : interval.covariance()(c, r));
  // One error of gravity in all of the interval: velocity and position move together.
  const double dt = 0.3;
  Eigen::MatrixXd by_gravity = Eigen::MatrixXd::Zero(9, 3);
  by_gravity.middleRows(3, 3) = dt * Matrix3d::Identity();
  by_gravity.bottomRows(3) = dt * dt / 2 * Matrix3d::Identity();
  const Eigen::MatrixXd expected = covariance + by_gravity * by_gravity.transpose();

  GraphFixture<Native> f;
  Window<Native> window(f.memory, GraphCapacity{});
  const KeyframeState<Native> state = motion.state<Native>(0);
  f.graph.add_keyframe(state, f.no_motion.record());
  f.graph.add_keyframe(state, interval.record());
  take_snapshot<Native>(f.graph, ImuNoise{}, f.memory, window);
  const MatrixView<Native> factor = window.interval(1).covariance();
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(9, 9);
  for (int r = 0; r < 9; ++r)
    for (int c = 0; c <= r; ++c)
      L(r, c) = r == c ? 1 / static_cast<double>(factor(r, c)) : static_cast<double>(factor(r, c));
  EXPECT_LT((L * L.transpose() - expected).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_GT(window.interval(1).duration(), 0.29f);
}

TEST(SnapshotIntervals, BiasOfTheWindowIsEstimated) {
  // Samples with a bias, integrated without subtracting it, between true poses.
  const Motion motion;
  const Vector3d gyro(0.02, -0.05, 0.08);
  GraphFixture<Native> f;
  Window<Native> window(f.memory, GraphCapacity{});
  const OwnedInterval<Native> interval;
  for (int k = 0; k < 8; ++k) {
    if (k == 0)
      interval.reset(ImuBias<Native>::zero());
    else
      integrate<Native>(motion, 0.2 * (k - 1), 0.2 * k, 40, interval, ImuBias<Native>::zero(),
                        gyro);
    f.graph.add_keyframe(motion.state<Native>(0.2 * k), interval.record());
  }
  take_snapshot<Native>(f.graph, ImuNoise{}, f.memory, window);
  estimate_biases<Native>(window, ImuNoise{}, {});
  EXPECT_LT((to_eigen<Native>(window.bias.gyro) - gyro).norm(), 1e-3);
}

TEST(Snapshot, CountsWhatItComputesNatively) {
  const OptimiserScene<Native> native;
  const OptimiserScene<Counting> counting;
  const Window<Native>& a = native.window;
  const Window<Counting>& b = counting.window;
  ASSERT_EQ(a.landmarks, b.landmarks);
  const auto n = static_cast<std::size_t>(a.landmarks);
  EXPECT_EQ(0, std::memcmp(a.state.points.data(), b.state.points.data(), 12 * n));
  EXPECT_EQ(0, std::memcmp(a.first_observations.data(), b.first_observations.data(), 2 * n));
  EXPECT_EQ(0, std::memcmp(a.observation_numbers.data(), b.observation_numbers.data(), n));
  EXPECT_EQ(0, std::memcmp(a.interval(1).record().data(), b.interval(1).record().data(),
                           7 * 4 * Preintegration<Native>::kFloats));
}

}  // namespace
}  // namespace leviosim::vio::test
