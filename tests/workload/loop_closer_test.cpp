// Loops closed on flights through worlds of points: what drift is left, and that nothing is
// recognised that was never seen.
#include <gtest/gtest.h>

#include "tests/workload/loop_world.h"

namespace leviosim::vio::test {
namespace {

using Native = work::Native;

constexpr double kStep = 0.2;     ///< of a keyframe, m
constexpr float kSeconds = 0.2f;  ///< for it

struct Ending {
  double drift = 0;  ///< of the odometry at the end, m
  double error = 0;  ///< of the corrected pose at the end, m
  double worst = 0;  ///< of all corrected poses, m
  int closures = 0;
  int forgotten = 0;
  int places = 0;
};

/// Flies `metres` of laps, the last part of them, from `switch_at` on, in the other world.
Ending fly_laps(const HallOptions& hall, double metres, std::uint64_t seed,
                const std::vector<WorldPoint>* other = nullptr, double switch_at = 0) {
  const std::vector<WorldPoint> world = make_panels(hall);
  Random random(seed);
  DriftingOdometry odometry(random.uniform(-0.01, 0.01), random.uniform(-0.0005, 0.0005));
  LoopFlight<Native> flight{LoopOptions{}};
  Ending ending;
  for (double path = 0; path < metres; path += kStep) {
    const Eigen::Isometry3d T = pose_on_lap(hall, path);
    const Eigen::Isometry3d T_odometry = odometry.follow(T);
    const bool elsewhere = other != nullptr && path >= switch_at;
    const Sight sight = look(elsewhere ? *other : world, T, random);
    ending.places = flight.show(sight, T_odometry).places;
    const Eigen::Vector3d corrected = position_of(flight.corrected(T_odometry, kSeconds));
    ending.drift = (T_odometry.translation() - T.translation()).norm();
    ending.error = (corrected - T.translation()).norm();
    ending.worst = std::max(ending.worst, ending.error);
  }
  ending.closures = flight.closures;
  ending.forgotten = flight.forgotten;
  return ending;
}

TEST(LoopCloser, BringsTheDriftOfThreeLapsToAThirdOrLess) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    HallOptions hall;
    hall.texture_seed = seed;
    // What the odometry is sure to have drifted by then.
    const Ending ending = fly_laps(hall, 3 * lap_length(hall), seed);
    std::printf("seed %d drift %.3f error %.3f worst %.3f closures %d forgotten %d places %d\n",
                int(seed), ending.drift, ending.error, ending.worst, ending.closures,
                ending.forgotten, ending.places);
    EXPECT_GT(ending.closures, 0) << seed;
    EXPECT_LT(ending.error, std::max(ending.drift / 3, 0.08)) << seed;
  }
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
    std::printf("seed %d textures %d drift %.3f error %.3f worst %.3f closures %d\n", int(seed),
                hall.textures, ending.drift, ending.error, ending.worst, ending.closures);
    closures += ending.closures;
    EXPECT_LT(ending.error, ending.drift + 0.1) << seed;
  }
  EXPECT_GT(closures, 0);
}

TEST(LoopCloser, ClosesNoLoopBetweenTwoHalls) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    HallOptions hall, other;
    hall.textures = other.textures = seed % 2 == 0 ? 0 : 6;
    hall.seed = hall.texture_seed = seed;
    other.seed = 1000 + seed;
    other.texture_seed = seed % 2 == 0 ? 1000 + seed : seed;  // other textures, or others in place
    const std::vector<WorldPoint> second = make_panels(other);
    const double lap = lap_length(hall);
    const Ending ending = fly_laps(hall, 1.8 * lap, seed, &second, 0.9 * lap);
    EXPECT_EQ(ending.closures, 0) << seed;
  }
}

}  // namespace
}  // namespace leviosim::vio::test
