// What is said of a frame's features: as many of each kind as the frame counts, and nothing that is
// computed or counted changes where it is asked for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/workload/short_flight.h"

namespace leviosim::vio::test {
namespace {

/// Under way from its begin.
const ShortFlight& flight() {
  static const ShortFlight drawn = draw_flight(PacedFlight(3, at_pace(1.0, 3)), 4);
  return drawn;
}

struct Flown {
  std::vector<FrameReport> reports;
  std::vector<work::Job> jobs;
};

Flown fly(const char* profile_name, bool wants_features) {
  const Profile profile = profile_named(profile_name, 1);
  work::Machine cluster({8, "L1", Bytes(1 << 17), profile.l1_alignment, true, false});
  work::Machine controller({1, "L2", Bytes(1 << 22), 4, true, false});
  const auto odometry = make_odometry(true, profile, flight().rig, cluster, controller);
  Flown flown;
  for (const ShortFlight::Frame& frame : flight().frames) {
    const bool optimises = odometry->begin_optimisation();
    flown.reports.push_back(
        odometry->process_frame({frame.pixels.data(), flight().rig.width, flight().rig.height,
                                 0.05f, frame.imu, wants_features}));
    flown.jobs.push_back(cluster.take_job());
    for (int k = 0; optimises && k < profile.optimiser_iterations; ++k) odometry->optimise();
    if (optimises) odometry->publish();
    controller.take_job();
  }
  return flown;
}

int count(const FrameReport& report, FeatureState state) {
  return static_cast<int>(
      std::count_if(report.seen->begin(), report.seen->end(),
                    [&](const SeenFeature& feature) { return feature.state == state; }));
}

class SeenFeatures : public ::testing::TestWithParam<const char*> {};

TEST_P(SeenFeatures, AreAsManyAsTheFrameCounts) {
  const Flown flown = fly(GetParam(), true);
  int judged = 0, made = 0;
  for (const FrameReport& report : flown.reports) {
    ASSERT_TRUE(report.seen);
    EXPECT_EQ(std::ssize(*report.seen), report.features);
    made += count(report, FeatureState::New);
    if (!report.keyframe) {
      EXPECT_EQ(count(report, FeatureState::New), 0);
    }
    const bool located = report.source == PoseSource::Epnp || report.source == PoseSource::Tracked;
    if (!located || report.keyframe) continue;  // which sees landmarks through its matches, too
    EXPECT_EQ(count(report, FeatureState::Agrees), report.inliers);
    EXPECT_EQ(count(report, FeatureState::Rejected), report.world_matches - report.inliers);
    judged += count(report, FeatureState::Rejected);
  }
  EXPECT_GT(judged, 0);
  EXPECT_GT(made, 100);
}

TEST_P(SeenFeatures, LieInTheImageNearTheirMatches) {
  for (const FrameReport& report : fly(GetParam(), true).reports)
    for (const SeenFeature& feature : *report.seen) {
      EXPECT_GT(std::min(feature.x, feature.x_before), 0);
      EXPECT_GT(std::min(feature.y, feature.y_before), 0);
      EXPECT_LT(std::max(feature.x, feature.x_before), 160);
      EXPECT_LT(std::max(feature.y, feature.y_before), 120);
      if (feature.state == FeatureState::Detected) {
        EXPECT_EQ(feature.x, feature.x_before);
        EXPECT_EQ(feature.y, feature.y_before);
      }
      if (feature.state == FeatureState::New) {
        EXPECT_GT(std::hypot(feature.p_world[0], feature.p_world[1], feature.p_world[2]), 0);
      }
    }
}

TEST_P(SeenFeatures, ChangeNoWorkAndNoPose) {
  const Flown with = fly(GetParam(), true), without = fly(GetParam(), false);
  ASSERT_EQ(with.jobs.size(), without.jobs.size());
  for (std::size_t i = 0; i < with.jobs.size(); ++i) {
    EXPECT_FALSE(without.reports[i].seen);
    ASSERT_EQ(with.jobs[i].stages.size(), without.jobs[i].stages.size());
    for (std::size_t k = 0; k < with.jobs[i].stages.size(); ++k)
      EXPECT_EQ(work::counts_of(with.jobs[i].stages[k]), work::counts_of(without.jobs[i].stages[k]))
          << "frame " << i << ", " << with.jobs[i].stages[k].stage;
    EXPECT_EQ(with.reports[i].p_world_camera, without.reports[i].p_world_camera);
    EXPECT_EQ(with.reports[i].R_world_camera, without.reports[i].R_world_camera);
  }
}

INSTANTIATE_TEST_SUITE_P(Profiles, SeenFeatures, ::testing::Values("levio", "next"));

}  // namespace
}  // namespace leviosim::vio::test
