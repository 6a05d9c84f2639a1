// What the prior of a window knows from keyframes that have left it, and what it must not know.
#include "workload/graph/marginalisation.h"

#include <gtest/gtest.h>

#include "tests/workload/graph/optimiser_scene.h"
#include "workload/graph/departing_visual_terms.h"
#include "workload/vio/odometry/back_end.h"
#include "workload/vio/profile.h"

namespace leviosim::vio::test {
namespace {

using work::Native;

/// The scene's window after its oldest keyframe has departed.
struct Departed {
  Departed() : prior(scene.fc.local(), scene.graph.capacity.keyframes) {
    start_prior<Native>(scene.window, {}, prior);
    marginalise<Native>(scene.fc, scene.window, 1, scene.options.visual, {}, prior);
  }

  /// Information on a step of these unknowns by one.
  double information(const std::vector<int>& unknowns) const {
    const int n = prior.unknowns();
    double sum = 0;
    for (const int i : unknowns)
      for (const int j : unknowns) sum += static_cast<double>(prior.information[i * n + j]);
    return sum;
  }

  OptimiserScene<Native> scene;
  WindowPrior<Native> prior;
};

TEST(Marginalisation, ThePriorKnowsDistancesAndNoPlaces) {
  const Departed departed;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<int> all;
    for (int k = 0; k < departed.prior.keyframes; ++k) all.push_back(9 * k + 3 + axis);
    const double one = departed.information({all.front()});
    EXPECT_GT(one, 1.0);
    EXPECT_LT(std::abs(departed.information(all)), 1e-3 * one) << axis;
  }
}

/// Landmarks of the window that its oldest keyframe saw and its newest did not.
std::vector<int> departing(const OptimiserScene<Native>& scene) {
  std::vector<int> slots;
  for (std::size_t i = 0; i < scene.tracks.size(); ++i)
    if (scene.tracks[i].front().keyframe == 0 &&
        scene.tracks[i].back().keyframe != scene.scene.keyframes - 1)
      slots.push_back(static_cast<int>(i));
  return slots;
}

int observations_of(const PoseGraph<Native>& graph, int slot) {
  int number = 0;
  for (int o = 0; o < graph.observation_count(); ++o)
    number += graph.observation_landmarks[o] == slot &&
              graph.observation_generations[o] == graph.generations[slot];
  return number;
}

TEST(Marginalisation, WhatThePriorHoldsCountsNoMore) {
  OptimiserScene<Native> scene;
  Profile profile = profile_named("next", 1);
  profile.optimiser.visual = scene.options.visual;
  MapStatus map;
  map.aligned = true;
  BackEnd<Native> back_end(profile, Rig{}, scene.fc, scene.graph, map);
  ASSERT_TRUE(back_end.begin());
  back_end.optimise();
  back_end.publish();
  const std::vector<int> gone = departing(scene);
  ASSERT_GT(gone.size(), 10U);
  for (const int slot : gone) EXPECT_GT(observations_of(scene.graph, slot), 2);

  // One more keyframe: the oldest departs.
  const OwnedInterval<Native> interval;
  integrate<Native>(scene.motion, scene.time(7), scene.time(8), 40, interval,
                    ImuBias<Native>::zero());
  scene.graph.add_keyframe(scene.motion.state<Native>(scene.time(8)), interval.record());
  ASSERT_TRUE(back_end.begin());
  for (int slot = 0; slot < scene.scene.landmarks; ++slot) {
    const bool departs = std::find(gone.begin(), gone.end(), slot) != gone.end();
    if (departs)
      EXPECT_EQ(observations_of(scene.graph, slot), 0) << slot;
    else
      EXPECT_GT(observations_of(scene.graph, slot), 1) << slot;
  }
}

}  // namespace
}  // namespace leviosim::vio::test
