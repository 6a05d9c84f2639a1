// Loops closed on flights through worlds of points: what drift is left, and that nothing is
// recognised that was never seen.
#include <gtest/gtest.h>

#include "tests/workload/next/loop/loop_world.h"

namespace leviosim::vio::test {
namespace {

using Native = work::Native;

constexpr double kKeyframeStep = 0.2;  ///< of a keyframe, m
constexpr float kSeconds = 0.2f;       ///< for it

struct Ending {
  double drift = 0;  ///< of the odometry at the end, m
  double error = 0;  ///< of the corrected pose at the end, m
  double worst = 0;  ///< of all corrected poses, m
  int closures = 0;
  int removed = 0;
  int places = 0;
};

/// Flies `metres` of laps, the last part of them, from `switch_at` on, in the other world.
Ending fly_laps(const HallOptions& hall, double metres, std::uint64_t seed,
                const std::vector<WorldPoint>* other = nullptr, double switch_at = 0) {
  const std::vector<WorldPoint> world = make_panels(hall);
  Random random(seed);
  const double direction = random.uniform(0, 2 * std::numbers::pi);
  DriftingOdometry odometry(
      0.01 * Eigen::Vector3d(std::cos(direction), std::sin(direction), random.uniform(-0.5, 0.5)),
      random.uniform(-0.001, 0.001));
  LoopFlight<Native> flight{LoopOptions{}};
  Ending ending;
  for (double path = 0; path < metres; path += kKeyframeStep) {
    const Eigen::Isometry3d T = pose_on_lap(hall, path);
    const Eigen::Isometry3d T_odometry = odometry.follow(T);
    const bool elsewhere = other != nullptr && path >= switch_at;
    const Sight sight = look(elsewhere ? *other : world, T, random);
    ending.places = std::max(ending.places, flight.show(sight, T_odometry).places);
    const Eigen::Vector3d corrected = position_of(flight.corrected(T_odometry, kSeconds));
    ending.drift = (T_odometry.translation() - T.translation()).norm();
    ending.error = (corrected - T.translation()).norm();
    ending.worst = std::max(ending.worst, ending.error);
  }
  ending.closures = flight.closures;
  ending.removed = flight.removed;
  return ending;
}

TEST(LoopCloser, BringsTheDriftOfThreeLapsToAThirdOrLess) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    HallOptions hall;
    hall.texture_seed = seed;
    const Ending ending = fly_laps(hall, 3 * lap_length(hall), seed);
    EXPECT_GT(ending.closures, 0) << seed;
    EXPECT_GT(ending.drift, 0.5) << seed;
    EXPECT_LT(ending.error, ending.drift / 3) << seed;
    EXPECT_LE(ending.places, LoopOptions{}.places.places) << seed;
  }
}

TEST(LoopCloser, LeavesPosesAloneUntilALoopIsClosed) {
  const HallOptions hall;
  const std::vector<WorldPoint> world = make_panels(hall);
  Random random(1);
  LoopFlight<Native> flight{LoopOptions{}};
  for (double path = 0; path < 10; path += kKeyframeStep) {
    const Eigen::Isometry3d T = pose_on_lap(hall, path);
    flight.show(look(world, T, random), T);
    const Pose<Native> before = to_pose<Pose<Native>>(T), after = flight.corrected(T, kSeconds);
    EXPECT_EQ(before.t.x, after.t.x);
    EXPECT_EQ(before.R.m[0][2], after.R.m[0][2]);
  }
  EXPECT_EQ(flight.closures, 0);
}

/// A correction of d takes its time, and no step of it is larger than its share.
TEST(LoopCloser, AppliesACorrectionOverAWhile) {
  const HallOptions hall;
  const std::vector<WorldPoint> world = make_panels(hall);
  Random random(1);
  DriftingOdometry odometry({0.015, 0, 0}, 0);
  LoopOptions options;
  options.smoothing = 2;
  LoopFlight<Native> flight{options};
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  double largest = 0;
  for (double path = 0; path < lap_length(hall) + 6; path += kKeyframeStep) {
    const Eigen::Isometry3d T = pose_on_lap(hall, path);
    const Eigen::Isometry3d T_odometry = odometry.follow(T);
    flight.show(look(world, T, random), T_odometry);
    const Eigen::Vector3d correction =
        position_of(flight.corrected(T_odometry, kSeconds)) - T_odometry.translation();
    largest = std::max(largest, (correction - before).norm());
    before = correction;
  }
  EXPECT_GT(before.norm(), 0.2);
  // A tenth of it in each of ten steps, but for what further loops add.
  EXPECT_LT(largest, 0.25 * before.norm());
}

TEST(LoopCloser, IsTheSameUnderBothPolicies) {
  const HallOptions hall;
  const std::vector<WorldPoint> world = make_panels(hall);
  Random random(1);
  DriftingOdometry odometry({0.01, 0, 0}, 0);
  LoopOptions options;
  options.places.places = 40;
  LoopFlight<Native> plain{options};
  LoopFlight<work::Counting> counting{options, true};
  for (double path = 0; path < lap_length(hall) + 4; path += kKeyframeStep) {
    const Eigen::Isometry3d T = pose_on_lap(hall, path);
    const Eigen::Isometry3d T_odometry = odometry.follow(T);
    const Sight sight = look(world, T, random);
    const LoopOutcome a = plain.show(sight, T_odometry), b = counting.show(sight, T_odometry);
    ASSERT_EQ(a.places, b.places);
    ASSERT_EQ(a.closures, b.closures);
    const Pose<Native> p = plain.corrected(T_odometry, kSeconds);
    const Pose<work::Counting> q = counting.corrected(T_odometry, kSeconds);
    ASSERT_EQ(p.t.x, work::value(q.t.x));
    ASSERT_EQ(p.t.z, work::value(q.t.z));
    ASSERT_EQ(p.R.m[1][2], work::value(q.R.m[1][2]));
    counting.machine().take_job();
  }
  EXPECT_GT(plain.closures, 0);
  EXPECT_GT(plain.removed, 0);
}

TEST(LoopCloser, ClosesNoLoopWhereFewTexturesRepeatAndNothingIsSeenTwice) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    HallOptions hall;
    hall.textures = 1 + static_cast<int>(seed % 4);
    hall.seed = hall.texture_seed = seed;
    const Ending ending = fly_laps(hall, 0.85 * lap_length(hall), seed);
    EXPECT_EQ(ending.closures, 0) << seed;
  }
}

TEST(LoopCloser, ClosesNoFalseLoopWhereFewTexturesRepeat) {
  int closures = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    HallOptions hall;
    hall.textures = 1 + static_cast<int>(seed % 4);
    hall.seed = hall.texture_seed = seed;
    const Ending ending = fly_laps(hall, 2 * lap_length(hall), seed);
    closures += ending.closures;
    // A loop closed one panel off would leave metres.
    EXPECT_LT(ending.error, 0.4) << seed;
    EXPECT_LT(ending.worst, 0.5) << seed;
  }
  EXPECT_GT(closures, 0);
}

/// The other hall has other textures, or the same ones on walls that stand half a panel away. On
/// walls that stand alike, panels in a row with the same textures would be the same place.
TEST(LoopCloser, ClosesNoLoopBetweenTwoHalls) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    HallOptions hall, other;
    hall.seed = hall.texture_seed = seed;
    other.seed = 1000 + seed;
    other.texture_seed = 1000 + seed;
    if (seed % 2 == 1) {
      hall.textures = other.textures = 6;
      other.texture_seed = seed;
      other.shift = {1, 1};
    }
    const std::vector<WorldPoint> second = make_panels(other);
    const double lap = lap_length(hall);
    const Ending ending = fly_laps(hall, 1.8 * lap, seed, &second, 0.9 * lap);
    EXPECT_EQ(ending.closures, 0) << seed;
  }
}

}  // namespace
}  // namespace leviosim::vio::test
