// Single rules of the front end, each at its limit: what is just enough, and what is one too few.
#include <gtest/gtest.h>

#include <functional>

#include "tests/workload/vio/front_end_fixture.h"
#include "workload/vio/profile.h"

namespace leviosim::vio::test {
namespace {

using Change = std::function<void(Profile&)>;

/// The second frame shows the first one's picture, whose features are landmarks in the graph.
/// @param older  keyframes that pass before it
FrameReport with_landmarks(const Change& change, bool scrambled = false, int older = 0) {
  FrontEndAlone alone;
  change(alone.profile);
  alone.frame(alone.picture);
  alone.add_landmarks(alone.picture, scrambled);
  for (int i = 0; i < older; ++i) alone.graph.age_landmarks();
  return alone.frame(alone.picture);
}

TEST(FrontEndRules, EpnpNeedsItsMatches) {
  const int matches = with_landmarks([](Profile&) {}).world_matches;
  ASSERT_GE(matches, 50);
  EXPECT_EQ(with_landmarks([&](Profile& p) { p.min_world_matches = matches; }).source,
            PoseSource::Epnp);
  const FrameReport few = with_landmarks([&](Profile& p) { p.min_world_matches = matches + 1; });
  EXPECT_NE(few.source, PoseSource::Epnp);
  EXPECT_NE(few.source, PoseSource::Predicted);
  EXPECT_EQ(few.world_matches, matches);
}

TEST(FrontEndRules, EpnpNeedsItsMatchesAfterTheAgeFilterToo) {
  FrontEndAlone alone;
  alone.frame(alone.picture);
  alone.add_landmarks(alone.picture, false);
  const int half = work::value(alone.graph.landmark_count()) / 2;
  for (int i = 0; i < half; ++i) alone.graph.ages[i] = 200;
  alone.profile.min_world_matches = half + 20;
  const FrameReport report = alone.frame(alone.picture);
  EXPECT_LT(report.world_matches, half + 20);
  EXPECT_GT(report.world_matches, 0);
  EXPECT_NE(report.source, PoseSource::Epnp);
  EXPECT_NE(report.source, PoseSource::Predicted);
}

TEST(FrontEndRules, WithoutEpnpTheTwoViewsDecide) {
  const FrameReport report = with_landmarks([](Profile& p) { p.use_epnp = false; });
  EXPECT_NE(report.source, PoseSource::Epnp);
  EXPECT_NE(report.source, PoseSource::Predicted);
}

TEST(FrontEndRules, APoseOfEpnpNeedsItsInliers) {
  const FrameReport free = with_landmarks([](Profile& p) { p.min_epnp_inliers = 4; });
  ASSERT_EQ(free.source, PoseSource::Epnp);
  const auto needing = [](int inliers) {
    return with_landmarks([=](Profile& p) { p.min_epnp_inliers = inliers; });
  };
  EXPECT_EQ(needing(free.inliers).source, PoseSource::Epnp);
  EXPECT_EQ(needing(free.inliers + 1).source, PoseSource::Predicted);
}

TEST(FrontEndRules, LandmarksOfTheLargestAgeAreMatchedAndOlderOnesAreNot) {
  const int age = profile_named("levio", 1).max_landmark_age;
  EXPECT_GE(with_landmarks([](Profile&) {}, false, age).world_matches, 50);
  EXPECT_EQ(with_landmarks([](Profile&) {}, false, age + 1).world_matches, 0);
}

/// The second frame is the first one shifted, after so long, at a velocity of 0.5 m/s.
FrameReport shifted(const Change& change, float dt, float speed = 0.5f) {
  FrontEndAlone alone;
  change(alone.profile);
  alone.frame(alone.picture);
  alone.graph.set_keyframe(alone.graph.newest_keyframe(),
                           {Pose<work::Native>::identity(), {0.0f, speed, 0.0f}});
  const FrameReport report =
      alone.frame(turned_right(alone.picture), FrontEndAlone::kAtRest, Vector3d::Zero(), dt);
  return report;
}

double length(const FrameReport& report) {
  return Vector3d(double(report.p_world_camera[0]), double(report.p_world_camera[1]),
                  double(report.p_world_camera[2]))
      .norm();
}

TEST(FrontEndRules, TheEightPointPoseIsAsFarAsTheLastVelocityReachesInItsTime) {
  const float most = profile_named("levio", 1).max_translation_time;
  for (const float dt : {0.2f, 0.9f * most, most, 1.5f * most, 10.0f}) {
    const FrameReport report = shifted([](Profile&) {}, dt);
    ASSERT_EQ(report.source, PoseSource::EightPoint) << dt;
    EXPECT_NEAR(length(report), 0.5 * double(std::min(dt, most)), 1e-4) << dt;
  }
}

TEST(FrontEndRules, TheEightPointPoseMovesByTheLeastTranslationAtLeast) {
  const double least = double(profile_named("levio", 1).min_translation);
  EXPECT_NEAR(length(shifted([](Profile&) {}, 0.05f, 0)), least, 1e-6);
  EXPECT_NEAR(length(shifted([](Profile&) {}, 0.05f, 0.1f)), least, 1e-6);
}

TEST(FrontEndRules, TimeSinceTheKeyframeAddsUpOverFrames) {
  FrontEndAlone alone;
  alone.frame(alone.picture);
  alone.graph.set_keyframe(alone.graph.newest_keyframe(),
                           {Pose<work::Native>::identity(), {0.0f, 0.5f, 0.0f}});
  alone.profile.keyframe_parallax = 1;
  ASSERT_FALSE(alone.frame(turned_right(alone.picture)).keyframe);
  const FrameReport second = alone.frame(turned_right(alone.picture));
  ASSERT_EQ(second.source, PoseSource::EightPoint);
  EXPECT_NEAR(length(second), 0.5 * 0.1, 1e-5);
}

TEST(FrontEndRules, WithTooFewMatchesThePoseIsKeptAndTheFrameBecomesAKeyframe) {
  const auto needing = [](int matches) {
    return shifted(
        [=](Profile& p) {
          p.min_frame_matches = matches;
          p.keyframe_parallax = 1;
        },
        0.05f);
  };
  const int matches = needing(10).frame_matches;
  EXPECT_EQ(needing(matches).source, PoseSource::EightPoint);
  EXPECT_FALSE(needing(matches).keyframe);
  EXPECT_EQ(needing(matches + 1).source, PoseSource::Kept);
  EXPECT_TRUE(needing(matches + 1).keyframe);
  EXPECT_EQ(length(needing(matches + 1)), 0);
}

TEST(FrontEndRules, ParallaxIsInNormalisedCoordinates) {
  const auto with_limit = [](float limit) {
    return shifted([=](Profile& p) { p.keyframe_parallax = limit; }, 0.05f).keyframe;
  };
  constexpr float kShift = 12 / 114.66f;
  EXPECT_TRUE(with_limit(0.97f * kShift));
  EXPECT_FALSE(with_limit(1.03f * kShift));
}

TEST(FrontEndRules, AKeyframeMakesTheMapOlder) {
  FrontEndAlone alone;
  alone.frame(alone.picture);
  alone.add_landmarks(alone.picture, false);
  for (int k = 1; k <= 3; ++k) {
    ASSERT_TRUE(alone.frame(alone.flat).keyframe);
    EXPECT_EQ(int(alone.graph.ages[0]), k);
  }
}

TEST(FrontEndRules, TheSameViewGivesKeyframesNoLandmarks) {
  FrontEndAlone alone;
  alone.profile.keyframe_parallax = -1;
  alone.frame(alone.picture);
  const FrameReport report = alone.frame(alone.picture);
  EXPECT_TRUE(report.keyframe);
  EXPECT_EQ(report.landmarks, 0);
}

TEST(FrontEndRules, AShiftedViewGivesLandmarksThatBothKeyframesSee) {
  FrontEndAlone alone;
  alone.frame(alone.picture);
  alone.graph.set_keyframe(alone.graph.newest_keyframe(),
                           {Pose<work::Native>::identity(), {0.0f, 0.5f, 0.0f}});
  const FrameReport report = alone.frame(turned_right(alone.picture));
  ASSERT_TRUE(report.keyframe);
  EXPECT_GT(report.landmarks, 0);
  EXPECT_EQ(work::value(alone.graph.observation_count()), 2 * report.landmarks);
}

TEST(FrontEndRules, WithoutAnImuAKeyframeHasTheMeanVelocitySinceTheLast) {
  FrontEndAlone alone("levio-no-imu");
  alone.profile.keyframe_parallax = -1;
  alone.frame(alone.picture);
  alone.graph.set_keyframe(alone.graph.newest_keyframe(),
                           {Pose<work::Native>::identity(), {0.0f, 0.5f, 0.0f}});
  const FrameReport report =
      alone.frame(turned_right(alone.picture), FrontEndAlone::kAtRest, Vector3d::Zero(), 0.2f);
  ASSERT_TRUE(report.keyframe);
  const Vec3<work::Native> v = alone.newest().velocity;
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(to_eigen<work::Native>(v)[c],
                double(report.p_world_camera[static_cast<std::size_t>(c)]) / 0.2, 1e-5);
}

TEST(FrontEndRules, GravityUpdatesCanBeTurnedOff) {
  for (const bool updates : {false, true}) {
    FrontEndAlone alone;
    alone.profile.gravity_updates = updates;
    alone.frame(alone.flat, {4, -8, 1});
    const Vector3d first = to_eigen<work::Native>(alone.graph.gravity());
    for (int i = 0; i < 25; ++i) alone.frame(alone.flat);
    EXPECT_EQ((to_eigen<work::Native>(alone.graph.gravity()) - first).norm() > 1, updates);
  }
}

}  // namespace
}  // namespace leviosim::vio::test
