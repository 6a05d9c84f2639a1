// What `next` makes of flights on which something goes wrong: it says when it is lost, finds back,
// and never reports what is no number. The table in workload/ACCURACY.md is made of these flights.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

#include "tests/workload/short_flight.h"
#include "workload/vio/profile.h"

namespace leviosim::vio::test {
namespace {

/// From the first pose [m].
double farthest(const traces::Trajectory& poses) {
  double most = 0;
  for (const traces::StampedPose& pose : poses)
    most = std::max(
        most, (pose.T_world_body.translation() - poses.front().T_world_body.translation()).norm());
  return most;
}

struct Case {
  const char* name;
  void (*spoil)(ShortFlight&);
  double ate;        ///< at most [m]
  bool lost;         ///< some frames must be reported as lost
  float range[2]{};  ///< of gyro and accelerometer, where it matters [rad/s, m/s²]
};

/// The errors are bounds of 1.5 to 2 times what was measured, not what would be wished for.
constexpr std::array kCases{
    Case{"untouched", [](ShortFlight&) {}, 0.1, false},
    Case{"one frame in ten dropped",
         [](ShortFlight& f) { drop_frames(f, [](int i) { return i % 10 == 7; }); }, 0.1, false},
    Case{"ten frames in a row dropped",
         [](ShortFlight& f) { drop_frames(f, [](int i) { return i >= 100 && i < 110; }); }, 0.1,
         false},
    Case{"dark for a second", [](ShortFlight& f) { darken(f, 100, 120); }, 0.1, true},
    Case{"blurred for a second", [](ShortFlight& f) { blur(f, 100, 120); }, 0.1, true},
    Case{"gyro and accelerometer saturate",
         [](ShortFlight& f) { saturate(f, 0.35f, 9.9f); },
         0.8,
         false,
         {0.35f, 9.9f}},
    Case{"a patch moves with the camera",
         [](ShortFlight& f) { disturb_pictures(f, "occlusion-textured=30"); }, 0.1, false},
    Case{"no IMU for half a second", [](ShortFlight& f) { cut_imu(f, 100, 110); }, 0.2, false},
};

/// Rests for a second, then flies for seven.
const ShortFlight& from_rest() {
  static const ShortFlight flight = draw_flight(PacedFlight(3, at_pace(1)), 8);
  return flight;
}

class NextRobustness : public ::testing::TestWithParam<Case> {};

TEST_P(NextRobustness, SaysWhenItIsLostAndFindsBack) {
  ShortFlight flight = from_rest();
  GetParam().spoil(flight);
  Profile profile = profile_named("next", 1);
  if (GetParam().range[0] > 0) {
    profile.imu_uncertainty.gyro_range = GetParam().range[0];
    profile.imu_uncertainty.accel_range = GetParam().range[1];
  }
  const Flown flown = fly(flight, profile);
  EXPECT_TRUE(flown.finite);
  EXPECT_LT(flown.skew, 1e-4);
  EXPECT_LT(flown.ate, GetParam().ate);
  const int lost = flown.count(PoseSource::Predicted);
  if (GetParam().lost) {
    for (std::size_t i = 102; i < 118; ++i) EXPECT_EQ(flown.sources[i], PoseSource::Predicted) << i;
    EXPECT_EQ(flown.health[118], Health::unreliable);
  }
  if (flown.ate < 0.1) {
    EXPECT_EQ(flown.health[90], Health::good);
    EXPECT_EQ(flown.health.back(), Health::good);
  }
  EXPECT_LT(lost, 60);
  EXPECT_EQ(flown.sources.back(), PoseSource::Tracked);
  RecordProperty("ate_mm", static_cast<int>(flown.ate * 1000));
  RecordProperty("lost", lost);
}

INSTANTIATE_TEST_SUITE_P(Cases, NextRobustness, ::testing::ValuesIn(kCases), [](const auto& param) {
  std::string name = param.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

/// Median over three seeds of the random draws: single runs differ by a factor of two.
double median_ate(const ShortFlight& flight) {
  std::array<double, 3> ates{};
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const Flown flown = fly(flight, profile_named("next", seed));
    EXPECT_TRUE(flown.finite);
    EXPECT_LT(flown.skew, 1e-4);
    ates[seed - 1] = flown.ate;
  }
  std::sort(ates.begin(), ates.end());
  ::testing::Test::RecordProperty("ate_mm", static_cast<int>(ates[1] * 1000));
  return ates[1];
}

TEST(NextRobustnessOf, StartsInMotion) {
  EXPECT_LT(median_ate(draw_flight(PacedFlight(3, at_pace(1, 4)), 8)), 0.3);
}

/// On 8 % of the picture, which have a third of the matches and more in this room.
TEST(NextRobustnessOf, AnObjectThatMovesByItself) {
  ShortFlight flight = draw_flight(PacedFlight(3, at_pace(1, 6)), 6);
  disturb_pictures(flight, "moving-object=8");
  EXPECT_LT(median_ate(flight), 0.1);
  Profile believing = profile_named("next", 1);
  believing.own_motion.disagrees_px = 1000;
  EXPECT_GT(fly(flight, believing).ate, 0.2);
}

/// With an initialisation, the first poses are told anew when it comes.
TEST(NextRobustnessOf, StartsInMotionWithADelay) {
  const ShortFlight flight = draw_flight(PacedFlight(3, at_pace(1, 4)), 6);
  Profile profile = profile_named("next", 1);
  profile.initial_wait = 0;
  const Flown at_once = fly(flight, profile);
  ASSERT_GT(at_once.count(PoseSource::Initialising), 5);
  EXPECT_EQ(at_once.sources.back(), PoseSource::Tracked);
  profile.initial_wait = 4;
  const Flown delayed = fly(flight, profile);
  EXPECT_EQ(delayed.sources, at_once.sources);
  EXPECT_EQ(delayed.trajectory.back().T_world_body.matrix(),
            at_once.trajectory.back().T_world_body.matrix());
  EXPECT_NE(delayed.trajectory[3].T_world_body.matrix(),
            at_once.trajectory[3].T_world_body.matrix());
  EXPECT_LT(delayed.ate, at_once.ate);
  RecordProperty("ate_mm", static_cast<int>(delayed.ate * 1000));
  profile.initial_wait = 0.2f;  // which is over before anything is known
  EXPECT_EQ(fly(flight, profile).trajectory[3].T_world_body.matrix(),
            at_once.trajectory[3].T_world_body.matrix());
}

/// The IMU leads back to frames whose keyframes have left the map, or were of one that was given
/// up.
TEST(NextRobustnessOf, FramesBeforeAnEarlyDarknessAreCorrectedToo) {
  ShortFlight flight = draw_flight(PacedFlight(3, at_pace(1, 4)), 6);
  darken(flight, 4, 24);
  Profile profile = profile_named("next", 1);
  profile.initial_wait = 0;
  const Flown at_once = fly(flight, profile);
  profile.initial_wait = 5;
  const Flown delayed = fly(flight, profile);
  RecordProperty("at_once_mm", static_cast<int>(at_once.ate * 1000));
  RecordProperty("delayed_mm", static_cast<int>(delayed.ate * 1000));
  EXPECT_LT(delayed.ate, 0.1);
  EXPECT_LT(delayed.ate, 0.3 * at_once.ate);
}

/// What is seen after the alignment corrects the poses before it, as long as they wait.
TEST(NextRobustnessOf, PosesThatWaitLongerAreBetter) {
  const ShortFlight flight = draw_flight(PacedFlight(3, at_pace(1, 4)), 6);
  Profile profile = profile_named("next", 1);
  profile.initial_wait = 5;
  profile.settling_time = 0;
  const Flown aligned = fly(flight, profile);
  profile.settling_time = 1.5f;
  const Flown settled = fly(flight, profile);
  RecordProperty("aligned_mm", static_cast<int>(aligned.ate * 1000));
  RecordProperty("settled_mm", static_cast<int>(settled.ate * 1000));
  EXPECT_EQ(settled.sources, aligned.sources);
  EXPECT_LT(settled.ate, aligned.ate);
}

/// Images tell that a shaken vehicle stands where it stood, before and after rest was first told.
TEST(NextRobustnessOf, NudgeAtRestBeforeThereIsAMap) {
  for (const std::size_t first : {8u, 40u}) {
    ShortFlight flight = draw_flight(PacedFlight(3, at_pace(0)), 4);
    nudge(flight, first, first + 6);
    const Flown flown = fly(flight, profile_named("next", 1));
    ASSERT_TRUE(flown.finite);
    const double moved = farthest(flown.trajectory);
    EXPECT_LT(moved, 0.02) << first;
    RecordProperty("moved_mm", static_cast<int>(moved * 1000));
  }
}

TEST(NextRobustnessOf, FastMotion) {
  EXPECT_LT(median_ate(draw_flight(PacedFlight(3, at_pace(2.5)), 6)), 0.6);
}

TEST(NextRobustnessOf, StandsStillAfterMotion) {
  const Flown flown =
      fly(draw_flight(PacedFlight(3, with_standstill(5, 21)), 23), profile_named("next", 1));
  ASSERT_TRUE(flown.finite);
  EXPECT_LT(flown.ate, 0.1);
  const auto at = [&](int i) {
    return flown.trajectory[static_cast<std::size_t>(i)].T_world_body.translation();
  };
  double moved = 0;
  for (int i = 6 * 20; i <= 21 * 20; ++i) moved = std::max(moved, (at(i) - at(6 * 20)).norm());
  EXPECT_LT(moved, 0.03);
  RecordProperty("ate_mm", static_cast<int>(flown.ate * 1000));
  RecordProperty("moved_mm", static_cast<int>(moved * 1000));
}

/// Rest tells nothing of how far a map came that is not aligned yet: no motion is invented. Starts
/// in motion, so soon before a stop that no map is aligned by then.
TEST(NextRobustnessOf, StandsStillBeforeItsMapIsAligned) {
  const ShortFlight whole = draw_flight(PacedFlight(3, with_standstill(3, 9)), 8);
  for (const int first : {59, 62, 65, 68, 71}) {
    ShortFlight flight = whole;
    flight.frames.erase(flight.frames.begin(), flight.frames.begin() + first);
    const Flown flown = fly(flight, profile_named("next", 1));
    ASSERT_TRUE(flown.finite);
    const double moved = farthest(flown.trajectory);
    EXPECT_LT(moved, 0.02) << first;
  }
}

/// What idling rotors shake is no motion, as images show: the vehicle rests on, and nothing of its
/// path is in doubt.
TEST(NextRobustnessOf, RestsOnWhileItsRotorsIdle) {
  ShortFlight flight = draw_flight(PacedFlight(3, at_pace(0)), 4);
  nudge(flight, 30, 80, 0.15f);  // 0.07 rad/s of standard deviation
  const Flown flown = fly(flight, profile_named("next", 1));
  ASSERT_TRUE(flown.finite);
  EXPECT_LT(farthest(flown.trajectory), 1e-3);
  for (std::size_t i = 30; i < 80; ++i) {
    EXPECT_EQ(flown.sources[i], PoseSource::First) << i;
    EXPECT_EQ(flown.health[i], Health::good) << i;
  }
}

/// Images that stand still while the IMU leads away show what moves with the camera.
TEST(NextRobustnessOf, DoesNotRestOnWhereItsImuLeadsAway) {
  ShortFlight flight = draw_flight(PacedFlight(3, at_pace(0)), 4);
  for (std::size_t i = 40; i < 60; ++i)
    for (ImuInput& sample : flight.frames[i].imu) sample.accel[0] += 2;
  const Flown flown = fly(flight, profile_named("next", 1));
  ASSERT_TRUE(flown.finite);
  EXPECT_EQ(flown.sources[39], PoseSource::First);
  EXPECT_GE(
      std::count(flown.sources.begin() + 40, flown.sources.begin() + 60, PoseSource::Predicted),
      10);
  EXPECT_EQ(flown.health[59], Health::unreliable);
}

/// A gyro's bias below 0 there cannot be, so every map after the first frame's is refused.
TEST(NextRobustnessOf, SaysWhenItsMapStartsAnew) {
  const ShortFlight flight = draw_flight(PacedFlight(3, at_pace(1, 4)), 1);
  Profile profile = profile_named("next", 1);
  EXPECT_EQ(fly(flight, profile).map_restarts, 0);
  profile.recovery.max_gyro_bias = 0;
  const Flown refused = fly(flight, profile);
  EXPECT_EQ(refused.map_restarts, static_cast<int>(flight.frames.size()) - 1);
  EXPECT_EQ(refused.count(PoseSource::First), static_cast<int>(flight.frames.size()));
}

/// Not even while there is no map yet that they would contradict.
TEST(NextRobustnessOf, FrozenImagesInFlightAreNoRest) {
  ShortFlight flight = draw_flight(PacedFlight(3, at_pace(1, 4)), 4);
  freeze(flight, 5, 45);
  const Flown flown = fly(flight, profile_named("next", 1));
  ASSERT_TRUE(flown.finite);
  EXPECT_EQ(flown.count(PoseSource::First), 1);
  for (std::size_t i = 5; i < 45; ++i) EXPECT_EQ(flown.health[i], Health::unreliable) << i;
}

/// An IMU that sees rest, as in uniform motion, does not hold the pose while the images move.
TEST(NextRobustnessOf, ImuAtRestWhileTheImagesMove) {
  ShortFlight flight = from_rest();
  for (std::size_t i = 100; i < 150; ++i)
    for (ImuInput& sample : flight.frames[i].imu) {
      const float dt = sample.dt;
      sample = flight.frames[100].imu.front();
      sample.dt = dt;
    }
  const Flown flown = fly(flight, profile_named("next", 1));
  ASSERT_TRUE(flown.finite);
  int held = 0;
  for (std::size_t i = 123; i < 150; ++i)
    held +=
        flown.trajectory[i].T_world_body.matrix() == flown.trajectory[i - 1].T_world_body.matrix();
  EXPECT_LE(held, 3);
}

/// Where hand-held flights begin, on a straight line while it turns about the vertical, both
/// evenly: its IMU measures what it would at rest, with other biases and another gravity.
class EvenFlight : public traces::Motion {
 public:
  /// @param velocity  m/s, in the world
  /// @param turn      rad/s
  EvenFlight(Eigen::Vector3d velocity, double turn, Pace pace)
      : velocity_(std::move(velocity)), turn_(turn), pace_(std::move(pace)) {}

  traces::MotionState at(double t_s) const override {
    const traces::Derivatives s = pace_(t_s);
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    traces::MotionState state = traces::HandHeldFlight(3).at(0);
    state.T_world_body.translation() += velocity_ * s.value;
    state.T_world_body.linear() =
        Eigen::AngleAxisd(turn_ * s.value, up) * state.T_world_body.linear();
    state.velocity = velocity_ * s.first;
    state.acceleration = velocity_ * s.second;
    state.angular_velocity = state.T_world_body.linear().transpose() * up * (turn_ * s.first);
    return state;
  }

 private:
  Eigen::Vector3d velocity_;
  double turn_;
  Pace pace_;
};

/// Frames that were taken for rest, of a flight that never rests.
int taken_for_rest(const Flown& flown) {
  EXPECT_TRUE(flown.finite);
  return flown.count(PoseSource::First) - 1;
}

/// An even turn that is too fast for a bias is never taken for rest; what an IMU cannot tell from
/// rest, until the images contradict.
TEST(NextRobustnessOf, EvenFlightIsNoRest) {
  const struct {
    Eigen::Vector3d velocity;
    double turn;
    int taken;
  } cases[] = {{{0, 0, 0}, 0.5, 0}, {{0, 0, 0}, 0.1, 2}, {{0, 0.2, 0}, 0, 2}, {{0.15, 0, 0}, 0, 8}};
  for (const auto& [velocity, turn, taken] : cases) {
    const Flown flown =
        fly(draw_flight(EvenFlight(velocity, turn, at_pace(1)), 4), profile_named("next", 1));
    EXPECT_LE(taken_for_rest(flown), taken) << velocity.transpose() << ", " << turn;
    EXPECT_EQ(flown.sources.back(), PoseSource::Initialising);
  }
}

/// Where most of what was matched has moved too far for one image, that is a motion as well.
TEST(NextRobustnessOf, FastEvenFlightIsNoRest) {
  ShortFlight flight = draw_flight(EvenFlight({0, 0.8, 0}, 0, at_pace(1)), 3);
  drop_frames(flight, [](int i) { return i % 3 != 0; });
  Profile profile = profile_named("next", 1);
  profile.stillness.batches = 8;  // just above a second
  EXPECT_LE(taken_for_rest(fly(flight, profile)), 2);
  profile.rest.fast_match = profile.rest.wrong_match;
  EXPECT_GE(taken_for_rest(fly(flight, profile)), 5);
}

/// Nor is a motion that begins so gently that the IMU sees no change.
TEST(NextRobustnessOf, RestEndsWithAMotionThatOnlyTheImagesShow) {
  const auto gently = [](double t) -> traces::Derivatives {
    const double since = std::max(0.0, t - 2);
    return {since * since / 2, since, since > 0 ? 1.0 : 0.0};
  };
  const ShortFlight flight = draw_flight(EvenFlight({0, 0.1, 0}, 0, gently), 5);
  const Flown flown = fly(flight, profile_named("next", 1));
  ASSERT_TRUE(flown.finite);
  EXPECT_EQ(flown.sources[39], PoseSource::First);
  EXPECT_EQ(std::count(flown.sources.begin() + 60, flown.sources.end(), PoseSource::First), 0);
}

/// An IMU without power.
TEST(NextRobustnessOf, ZerosAreNoRest) {
  ShortFlight flight = draw_flight(PacedFlight(3, at_pace(0)), 2);
  EXPECT_GT(fly(flight, profile_named("next", 1)).count(PoseSource::First), 10);
  for (ShortFlight::Frame& frame : flight.frames)
    for (ImuInput& sample : frame.imu) sample = {sample.dt, {}, {}};
  const Flown flown = fly(flight, profile_named("next", 1));
  EXPECT_LE(taken_for_rest(flown), 1 + flown.map_restarts);
  EXPECT_NE(flown.health.back(), Health::good);
}

}  // namespace
}  // namespace leviosim::vio::test
