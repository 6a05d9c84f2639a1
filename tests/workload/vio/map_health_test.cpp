// What the odometry says of its map without the truth: each sign by itself.
#include "workload/vio/odometry/map_health.h"
#include "workload/vio/profile.h"

#include <gtest/gtest.h>

#include <cmath>

namespace leviosim::vio::test {
namespace {

constexpr float kFrame = 0.05f;  // s

class MapHealthOf : public ::testing::Test {
 protected:
  MapHealthOf() { map_.aligned = true; }

  /// A frame, a decimetre further on.
  Health frame(PoseSource source = PoseSource::Tracked, int restarts = 0) {
    FrameReport report;
    report.source = source;
    report.world_matches = 100;
    report.inliers = inliers_;
    report.map_restarts = restarts;
    report.at_rest = at_rest_;
    report.earlier = earlier_;
    report.p_world_camera = {0.1f * static_cast<float>(++frames_), 0, 0};
    return health_.after_frame(report, kFrame);
  }
  /// The same while the `number` frames before, 0.1 m apart times `scale`, are corrected still.
  Health correcting(int number, float scale = 1) {
    for (int ago = 1; ago <= number; ++ago) {
      EarlierPose pose;
      pose.frames_ago = ago;
      pose.p_world_camera = {0.1f * scale * static_cast<float>(frames_ + 1 - ago), 0, 0};
      earlier_.push_back(pose);
    }
    const Health health = frame();
    earlier_.clear();
    return health;
  }
  Health frames(int number, PoseSource source = PoseSource::Tracked) {
    Health last = Health::good;
    for (int i = 0; i < number; ++i) last = frame(source);
    return last;
  }
  void window(const WindowFit& fit) {
    map_.fit = fit;
    health_.take_window();
  }

  const Profile profile_ = profile_named("next", 1);
  MapStatus map_;
  MapHealth health_{profile_, map_};
  std::vector<EarlierPose> earlier_;
  int inliers_ = 95;
  int at_rest_ = 0;
  int frames_ = 0;
};

TEST_F(MapHealthOf, TrackedFramesOfAnAlignedMapAreGood) {
  EXPECT_EQ(frame(), Health::good);
  window({.visual = 0.5f, .inertial = 0.2f, .prior = -0.1f, .accel_bias = 2});
  EXPECT_EQ(frames(40), Health::good);
}

TEST_F(MapHealthOf, AMapWithoutScaleIsUnreliable) {
  map_.aligned = false;
  EXPECT_EQ(frame(PoseSource::Initialising), Health::unreliable);
  map_.aligned = true;
  EXPECT_EQ(frame(), Health::good);
}

/// The path until the alignment has its scale, and images do not put it right later.
TEST_F(MapHealthOf, AScaleThatIsKnownToAFifthMakesThePathSoFarUnreliable) {
  const auto aligned_with = [&](float sigma) {
    map_.aligned = false;
    frames(10, PoseSource::Initialising);
    map_.aligned = true;
    window({.scale_sigma = sigma});
    return frame();
  };
  EXPECT_EQ(aligned_with(0.05f), Health::good);
  EXPECT_EQ(aligned_with(0.3f), Health::unreliable);  // of one of two metres
  window({.scale_sigma = 0.02f});
  EXPECT_EQ(frames(5), Health::unreliable);
  EXPECT_EQ(frames(30), Health::good);  // of one of five
}

TEST_F(MapHealthOf, AWindowThatCannotBeSolvedAddsItsPath) {
  EXPECT_EQ(frames(10), Health::good);
  window({.scale_sigma = 0.04f});
  EXPECT_EQ(frames(100), Health::good);
  window({.scale_sigma = 0.04f, .solved = false});
  EXPECT_EQ(frames(5), Health::good);
  EXPECT_EQ(frames(5), Health::unreliable);
}

/// Poses that wait are corrected with their map: they have its present scale, and length, however
/// wrong those of the alignment were. After that nothing corrects them.
TEST_F(MapHealthOf, PosesThatAreCorrectedStillHaveThePresentScale) {
  map_.aligned = false;
  frames(40, PoseSource::Initialising);
  map_.aligned = true;
  window({.scale_sigma = 0.15f});
  EXPECT_EQ(correcting(20), Health::unreliable);
  window({.scale_sigma = 0.05f});
  EXPECT_EQ(correcting(20), Health::good);
  window({.scale_sigma = 0.15f});
  EXPECT_EQ(correcting(20), Health::unreliable);
  EXPECT_EQ(frame(), Health::unreliable);
  window({.scale_sigma = 0.0f});
  EXPECT_EQ(frames(5), Health::unreliable);  // 15 % of two metres and a decimetre
  EXPECT_EQ(frames(12), Health::good);
}

/// What a window said of the scale does not become certain because a map begins at rest.
TEST_F(MapHealthOf, AMapThatBeginsAtRestLeavesThePathWithTheScaleThatWasKnown) {
  window({.scale_sigma = 0.15f});
  EXPECT_EQ(correcting(20), Health::unreliable);
  map_.fit = {};
  EXPECT_EQ(frame(PoseSource::First), Health::unreliable);
  EXPECT_EQ(frame(PoseSource::First), Health::unreliable);
}

/// Guesses are not judged: their length is no path beside which an error would be small.
TEST_F(MapHealthOf, GuessesBeforeAMapThatBeginsAtRestAreNoPath) {
  map_.aligned = false;
  frames(40, PoseSource::Initialising);
  EXPECT_EQ(health_.path(), 0);
  frame(PoseSource::First);
  map_.aligned = true;
  EXPECT_EQ(frame(PoseSource::First), Health::good);
  frames(10, PoseSource::Predicted);
  EXPECT_NEAR(health_.path(), 1.0f, 0.01f);  // and not five
  EXPECT_EQ(frame(PoseSource::Tracked), Health::unreliable);
}

/// Then the IMU alone is wrong by what its acceleration is, not by a velocity that nobody knows.
TEST_F(MapHealthOf, TheVelocityAfterRestIsKnown) {
  const auto blind_from = [&](int at_rest) {
    const float before = health_.path_deviation();
    at_rest_ = at_rest;
    frame(at_rest > 0 ? PoseSource::First : PoseSource::Tracked);
    at_rest_ = 0;
    frames(10, PoseSource::Predicted);
    return health_.path_deviation() - before;
  };
  const float after_rest = blind_from(1);
  EXPECT_NEAR(after_rest, 0.5f * profile_.health.blind_acceleration * 0.5f * 0.5f, 1e-3f);
  frame();
  EXPECT_NEAR(blind_from(0), after_rest + 0.5f * profile_.health.blind_velocity, 1e-3f);
}

/// What is less than the noise of poses is not seen, however short the path is.
TEST_F(MapHealthOf, APathIsNotUncertainByLessThanTheNoiseOfPoses) {
  window({.scale_sigma = 0.3f});
  EXPECT_EQ(frames(2), Health::good);  // 0.03 m of 0.1 m: the first frame is where it begins
  EXPECT_NEAR(health_.path(), 0.1f, 1e-4f);
  EXPECT_NEAR(health_.path_deviation(), 0.03f, 1e-3f);
  EXPECT_EQ(frame(), Health::unreliable);  // 0.06 m of 0.2 m
}

/// A map in a wrong minimum is sure of what it found, and wanders on.
TEST_F(MapHealthOf, AScaleThatWindowsChangeAgainAndAgainIsUncertainForAWhile) {
  window({.scale_sigma = 0.03f});
  for (int i = 0; i < 40; ++i) EXPECT_EQ(correcting(20, i % 2 == 0 ? 1 : 1.02f), Health::good);
  float scale = 1.2f;
  EXPECT_EQ(correcting(20, scale), Health::unreliable);
  for (int i = 0; i < 20; ++i) correcting(20, scale);
  EXPECT_EQ(correcting(20, scale), Health::good);  // one correction comes to rest
  for (int i = 0; i < 10; ++i) correcting(20, scale *= 0.95f);
  EXPECT_EQ(correcting(20, scale), Health::unreliable);
  for (int i = 0; i < 60; ++i) correcting(20, scale);
  EXPECT_EQ(correcting(20, scale), Health::good);
}

/// What the alignment itself changes was a guess before.
TEST_F(MapHealthOf, AnAlignmentMayChangeTheScale) {
  map_.aligned = false;
  for (int i = 0; i < 10; ++i) correcting(20, i % 2 == 0 ? 1 : 3);
  map_.aligned = true;
  window({.scale_sigma = 0.03f});
  EXPECT_EQ(correcting(20), Health::good);
  EXPECT_EQ(correcting(20), Health::good);
}

/// What it grows by at its end is no correction.
TEST_F(MapHealthOf, APathThatGrowsFasterAndFasterIsNotCorrected) {
  window({.scale_sigma = 0.03f});
  for (int newest = 20; newest < 60; ++newest) {
    for (int ago = 1; ago <= 20; ++ago) {
      earlier_.emplace_back();
      earlier_.back().p_world_camera[0] = std::pow(1.1f, static_cast<float>(newest - ago));
    }
    EXPECT_EQ(frame(), Health::good);
    earlier_.clear();
  }
}

/// Older poses are forgotten as new ones come.
TEST_F(MapHealthOf, APathThatLosesItsOldestPoseIsAsLong) {
  window({.scale_sigma = 0.03f});
  for (int i = 0; i < 60; ++i) EXPECT_EQ(correcting(i < 30 ? 20 : 3), Health::good);
  EXPECT_NEAR(health_.path(), 7.9f, 0.01f);  // 20 poses before the first of 60 frames
  EXPECT_NEAR(health_.path_deviation(), 0.03f * 7.9f, 0.01f);
}

/// What the IMU alone found was wrong by as much.
TEST_F(MapHealthOf, ACorrectionAfterBlindFramesIsDrift) {
  EXPECT_EQ(frames(60), Health::good);
  EXPECT_EQ(frames(4, PoseSource::Predicted), Health::good);
  frames_ += 10;  // a metre of seven
  EXPECT_EQ(frames(20), Health::unreliable);
  EXPECT_EQ(frames(60), Health::good);
}

/// Each sign by itself, and with it nothing else.
TEST_F(MapHealthOf, SaysWhyItIsNotGood) {
  using Reason = HealthReason;
  frames(60);
  EXPECT_EQ(health_.reasons(), 0);
  window({.visual = 20});
  frame();
  EXPECT_EQ(health_.reasons(), bit(Reason::Inconsistent));
  window({});
  frames(21);
  EXPECT_EQ(health_.reasons(), 0);
  inliers_ = 5;
  frames(40);
  EXPECT_EQ(health_.reasons(), bit(Reason::FewInliers));
  inliers_ = 95;
  frames(60);
  EXPECT_EQ(health_.reasons(), 0);
  frames(12, PoseSource::Predicted);
  EXPECT_EQ(health_.reasons(), bit(Reason::Blind));
  window({.accel_bias = 6});
  frame();
  EXPECT_EQ(health_.reasons(), bit(Reason::AccelBias));
}

TEST_F(MapHealthOf, SaysThatTheScaleIsNotKnownOrTheMapBegunAgain) {
  using Reason = HealthReason;
  map_.aligned = false;
  frame(PoseSource::Initialising);
  EXPECT_EQ(health_.reasons() & ~bit(Reason::Drift), bit(Reason::NoScale));
  map_.aligned = true;
  frames(60);
  map_.aligned = false;
  EXPECT_EQ(frame(PoseSource::First, 1), Health::lost);
  EXPECT_EQ(health_.reasons() & ~bit(Reason::Drift), bit(Reason::NoScale) | bit(Reason::Restarted));
}

/// A drift of a metre in two.
TEST_F(MapHealthOf, SaysThatThePathIsUncertain) {
  frames(20);
  window({.scale_sigma = 0.5f});
  frames(20);
  EXPECT_EQ(health_.reasons(), bit(HealthReason::Drift));
}

/// levio has no windows that would tell.
TEST(MapHealth, DoesNotJudgeWithoutTheJointOptimiser) {
  const Profile profile = profile_named("levio", 1);
  const MapStatus map;
  MapHealth health(profile, map);
  FrameReport report;
  report.source = PoseSource::First;
  EXPECT_EQ(health.after_frame(report, 0), Health::not_judged);
}

TEST_F(MapHealthOf, AWindowThatContradictsItselfCountsForASecond) {
  window({.visual = 20});
  EXPECT_EQ(frame(), Health::unreliable);
  window({.visual = 0.5f});
  EXPECT_EQ(frames(18), Health::unreliable);
  EXPECT_EQ(frames(3), Health::good);  // nothing of the path is in doubt
}

/// The scale may be anything then.
TEST_F(MapHealthOf, APathThatContradictsTheImuStaysInDoubt) {
  EXPECT_EQ(frames(50), Health::good);
  window({.visual = 0.5f, .inertial = 20});
  frames(20);
  window({.visual = 0.5f, .inertial = 0.2f});
  EXPECT_EQ(frames(60), Health::unreliable);  // 2 m of 13 m
  EXPECT_EQ(frames(100), Health::good);       // 2 m of 23 m
}

TEST_F(MapHealthOf, ABiasThatNoAccelerometerHasIsUnreliableAndThenLost) {
  window({.accel_bias = 6});
  EXPECT_EQ(frame(), Health::unreliable);
  window({.accel_bias = 12});
  EXPECT_EQ(frame(), Health::lost);
}

TEST_F(MapHealthOf, WhatIsNoNumberIsNotGood) {
  window({.visual = NAN});
  EXPECT_EQ(frame(), Health::unreliable);
  window({.accel_bias = NAN});
  EXPECT_EQ(frame(), Health::lost);
}

TEST_F(MapHealthOf, PosesOfTheImuAloneAreUnreliableAfterAMomentAndLostInTheEnd) {
  EXPECT_EQ(frames(20), Health::good);
  EXPECT_EQ(frames(2, PoseSource::Predicted), Health::good);
  EXPECT_EQ(frames(20, PoseSource::Predicted), Health::unreliable);
  EXPECT_EQ(frames(45, PoseSource::Predicted), Health::lost);
}

/// They do not make those unreliable that follow, but for what they got wrong.
TEST_F(MapHealthOf, ImagesThatReturnInTimeAreGoodAtOnce) {
  EXPECT_EQ(frames(60), Health::good);
  inliers_ = 0;
  EXPECT_EQ(frames(9, PoseSource::Predicted), Health::good);
  EXPECT_EQ(frames(6, PoseSource::Predicted), Health::unreliable);
  inliers_ = 95;
  EXPECT_EQ(frame(), Health::good);
}

TEST_F(MapHealthOf, MatchesThatDisagreeAreUnreliable) {
  inliers_ = 55;
  EXPECT_EQ(frame(), Health::good);
  EXPECT_EQ(frames(40), Health::unreliable);
  inliers_ = 95;
  EXPECT_EQ(frames(40), Health::good);
}

TEST_F(MapHealthOf, AMapThatIsGivenUpIsLostUntilTheNextOneIsAligned) {
  frames(20);
  map_.aligned = false;
  EXPECT_EQ(frame(PoseSource::Initialising, 1), Health::lost);
  EXPECT_EQ(frames(20, PoseSource::Initialising), Health::lost);
  map_.aligned = true;
  EXPECT_EQ(frame(), Health::unreliable);  // a metre of four may be missing
  EXPECT_EQ(frames(80), Health::good);
}

/// Nothing depended on it.
TEST_F(MapHealthOf, AMapThatIsGivenUpBeforeItsAlignmentIsOnlyUnreliable) {
  map_.aligned = false;
  frame(PoseSource::Initialising);
  EXPECT_EQ(frame(PoseSource::Initialising, 1), Health::unreliable);
  map_.aligned = true;
  EXPECT_EQ(frame(), Health::good);
}

}  // namespace
}  // namespace leviosim::vio::test
