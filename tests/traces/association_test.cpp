#include "traces/trajectories/association.h"

#include <gtest/gtest.h>

#include <cmath>

namespace leviosim::traces {
namespace {

TEST(Associate, InterpolatesBetweenTheSamplesOfTheTruth) {
  Trajectory truth;
  truth.push_back({0, Eigen::Isometry3d::Identity()});
  truth.push_back(
      {10, Eigen::Translation3d(10, 20, 30) * Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX())});
  const auto matches = associate({{3, Eigen::Isometry3d::Identity()}}, truth, 5);
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_TRUE(matches[0].truth.translation().isApprox(Eigen::Vector3d(3, 6, 9)));
  EXPECT_TRUE(matches[0].truth.linear().isApprox(
      Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()).toRotationMatrix()));
}

TEST(Associate, LeavesOutWhatIsTooFarFromASample) {
  Trajectory truth;
  for (const std::int64_t t_ns : {0, 100, 200, 300})
    truth.push_back({t_ns, Eigen::Isometry3d::Identity()});
  Trajectory estimate;
  for (const std::int64_t t_ns : {-5, 0, 11, 10, 90, 89, 150, 300, 301})
    estimate.push_back({t_ns, Eigen::Isometry3d::Identity()});
  std::vector<std::int64_t> matched;
  for (const MatchedPose& match : associate(estimate, truth, 10)) matched.push_back(match.t_ns);
  EXPECT_EQ(matched, (std::vector<std::int64_t>{0, 10, 90, 300}));
}

TEST(DistancesAlong, FollowTheSamplesOfTheTruthBetweenTheMatches) {
  // The truth goes around two corners; the matches see neither.
  Trajectory truth;
  const std::vector<Eigen::Vector3d> corners{{0, 0, 0}, {3, 0, 0}, {3, 4, 0}, {3, 4, 12}};
  for (std::size_t i = 0; i < corners.size(); ++i)
    truth.push_back(
        {static_cast<std::int64_t>(i) * 100, Eigen::Isometry3d(Eigen::Translation3d(corners[i]))});
  Trajectory estimate;
  for (const std::int64_t t_ns : {50, 150, 300})
    estimate.push_back({t_ns, Eigen::Isometry3d::Identity()});
  const std::vector<double> distances = distances_along(truth, associate(estimate, truth, 50));
  ASSERT_EQ(distances.size(), 3u);
  EXPECT_EQ(distances[0], 0);
  EXPECT_DOUBLE_EQ(distances[1], 1.5 + 2);
  EXPECT_DOUBLE_EQ(distances[2], 1.5 + 4 + 12);
  EXPECT_TRUE(distances_along(truth, {}).empty());
}

}  // namespace
}  // namespace leviosim::traces
