#include "traces/trajectories/trajectory_errors.h"

#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"

namespace leviosim::traces {
namespace {

/// Poses at x = 0, 1, 2, … and times in steps of 10 ms.
Trajectory straight(std::size_t count, double scale = 1) {
  Trajectory trajectory;
  for (std::size_t i = 0; i < count; ++i)
    trajectory.push_back(
        {static_cast<std::int64_t>(i) * 10'000'000,
         Eigen::Isometry3d(Eigen::Translation3d(scale * static_cast<double>(i), 0, 0))});
  return trajectory;
}

Evaluation unaligned(const Trajectory& estimate, const Trajectory& truth) {
  EvaluationOptions options;
  options.alignment = Alignment::none;
  return evaluate(estimate, truth, options);
}

TEST(RelativeErrors, AWrongScaleIsThatPercentage) {
  const RelativeErrors errors = relative_errors(unaligned(straight(11, 1.02), straight(11)), 4);
  EXPECT_EQ(errors.length_m, 4);
  EXPECT_EQ(errors.count, 7u);  // from x = 0, 1, … 6
  EXPECT_NEAR(errors.translation.mean, 2, 1e-12);
  EXPECT_NEAR(errors.translation.max, 2, 1e-12);
  EXPECT_EQ(errors.rotation_deg_per_m.max, 0);
}

TEST(RelativeErrors, EndAtTheFirstPoseThatIsFarEnough) {
  // Four metres are reached at the fourth pose, 3.5 m as well.
  const Evaluation evaluation = unaligned(straight(11, 1.5), straight(11));
  EXPECT_EQ(relative_errors(evaluation, 3.5).count, 7u);
  EXPECT_NEAR(relative_errors(evaluation, 3.5).translation.mean, 100 * 4 * 0.5 / 3.5, 1e-12);
}

TEST(RelativeErrors, CountEveryTurnOncePerLength) {
  // The estimate turns by 6 degrees between the poses 5 and 6 and nowhere else.
  Trajectory estimate = straight(11);
  for (std::size_t i = 6; i < 11; ++i)
    estimate[i].T_world_body.rotate(
        Eigen::AngleAxisd(6 * 3.14159265358979323846 / 180, Eigen::Vector3d::UnitY()));
  const RelativeErrors errors = relative_errors(unaligned(estimate, straight(11)), 2);
  EXPECT_EQ(errors.count, 9u);
  EXPECT_NEAR(errors.rotation_deg_per_m.max, 3, 1e-9);
  EXPECT_NEAR(errors.rotation_deg_per_m.mean, 2 * 3.0 / 9, 1e-9);
}

TEST(RelativeErrors, NoneWhereThePathIsTooShort) {
  const Evaluation evaluation = unaligned(straight(11), straight(11));
  EXPECT_EQ(relative_errors(evaluation, 10).count, 1u);
  const RelativeErrors none = relative_errors(evaluation, 10.001);
  EXPECT_EQ(none.count, 0u);
  EXPECT_EQ(none.translation.max, 0);
}

TEST(RelativeErrors, FortyMetresOfAWholeRecordedFlight) {
  const auto file = testing::recorded_data() / "euroc_motion" / "MH_01_easy" / "mav0" /
                    "state_groundtruth_estimate0" / "data.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  const Trajectory truth = read_euroc_trajectory(file);
  Trajectory estimate;
  for (std::size_t i = 0; i < truth.size(); i += 10) {
    estimate.push_back(truth[i]);
    estimate.back().T_world_body.translation() *= 1.01;
  }
  const Evaluation evaluation = unaligned(estimate, truth);
  EXPECT_NEAR(evaluation.path_length_m, 80.6, 1);  // as EuRoC's paper says
  const RelativeErrors errors = relative_errors(evaluation, 40);
  EXPECT_GT(errors.count, 1000u);
  // One per cent of the distance between the ends, which is no longer than the path.
  EXPECT_LT(errors.translation.max, 1.01);
  EXPECT_GT(errors.translation.max, 0.01);
}

}  // namespace
}  // namespace leviosim::traces
