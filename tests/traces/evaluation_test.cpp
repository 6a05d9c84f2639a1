#include "traces/trajectories/evaluation.h"
#include "traces/trajectories/trajectory_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

/// A helix, sampled every `step_ns` from time 0.
Trajectory helix(std::int64_t step_ns, std::size_t count) {
  Trajectory trajectory;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t t_ns = static_cast<std::int64_t>(i) * step_ns;
    const double s = static_cast<double>(t_ns) * 1e-9;
    trajectory.push_back({t_ns, Eigen::Translation3d(std::cos(s), std::sin(s), 0.3 * s) *
                                    Eigen::AngleAxisd(s, Eigen::Vector3d(0, 0.6, 0.8))});
  }
  return trajectory;
}

Trajectory moved(Trajectory trajectory, const Eigen::Isometry3d& by, double scale = 1) {
  for (StampedPose& pose : trajectory) {
    pose.T_world_body.translation() *= scale;
    pose.T_world_body = by * pose.T_world_body;
  }
  return trajectory;
}

Eigen::Isometry3d some_transform() {
  return Eigen::Translation3d(4, -5, 6) * Eigen::AngleAxisd(1.9, Eigen::Vector3d(2, 1, -2) / 3);
}

TEST(Evaluation, AlignmentTakesAwayWhatItMay) {
  const Trajectory truth = helix(5'000'000, 2001);
  const Trajectory every_tenth = helix(50'000'000, 201);
  EvaluationOptions options;
  const Evaluation rigid = evaluate(moved(every_tenth, some_transform()), truth, options);
  EXPECT_LT(rigid.translation.max, 1e-9);
  EXPECT_LT(rigid.rotation_rmse_deg, 1e-5);
  EXPECT_EQ(rigid.matched, 201u);

  const Trajectory scaled = moved(every_tenth, some_transform(), 1.7);
  EXPECT_GT(evaluate(scaled, truth, options).translation.rmse, 0.1);
  options.alignment = Alignment::sim3;
  const Evaluation similar = evaluate(scaled, truth, options);
  EXPECT_LT(similar.translation.max, 1e-9);
  EXPECT_NEAR(similar.alignment.scale, 1 / 1.7, 1e-12);
  options.alignment = Alignment::none;
  EXPECT_EQ(evaluate(every_tenth, truth, options).translation.max, 0);
}

TEST(Evaluation, FiguresAreThoseOfTheirDefinitions) {
  // Four poses off by 1, 2, 3 and 6 m along z, and by 10, 20, 30 and 40 degrees.
  Trajectory truth;
  Trajectory estimate;
  const std::vector<double> off{3, 1, 6, 2};
  for (int i = 0; i < 4; ++i) {
    truth.push_back({i * 1'000'000, Eigen::Isometry3d(Eigen::Translation3d(2.0 * i, 0, 0))});
    const double turn = (i + 1) * std::numbers::pi / 18;
    estimate.push_back({i * 1'000'000, Eigen::Translation3d(2.0 * i, 0, off[i]) *
                                           Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY())});
  }
  EvaluationOptions options;
  options.alignment = Alignment::none;
  options.expected_poses = 8;
  const Evaluation result = evaluate(estimate, truth, options);
  EXPECT_DOUBLE_EQ(result.translation.rmse, std::sqrt((1 + 4 + 9 + 36) / 4.0));
  EXPECT_DOUBLE_EQ(result.translation.mean, 3);
  EXPECT_DOUBLE_EQ(result.translation.median, 2.5);
  EXPECT_DOUBLE_EQ(result.translation.max, 6);
  EXPECT_NEAR(result.rotation_rmse_deg, std::sqrt((100 + 400 + 900 + 1600) / 4.0), 1e-6);
  EXPECT_DOUBLE_EQ(result.completion, 0.5);
  EXPECT_DOUBLE_EQ(result.path_length_m, 6);
  EXPECT_EQ(result.protocol,
            "not aligned, 4 of 4 poses matched with interpolated truth (a sample within 10 ms), "
            "completion 50.0 % (8 expected poses), 6.00 m of path");
}

/// Whatever the alignment takes away.
TEST(Evaluation, SizeIsThatOfTheEstimateBeforeItsAlignment) {
  const Trajectory truth = helix(5'000'000, 2001);
  const Trajectory larger = moved(helix(50'000'000, 201), some_transform(), 1.25);
  for (const Alignment alignment : {Alignment::none, Alignment::se3, Alignment::sim3}) {
    EvaluationOptions options;
    options.alignment = alignment;
    EXPECT_NEAR(evaluate(larger, truth, options).size_ratio.value(), 1.25, 1e-6);
  }
  Trajectory rests = truth;
  for (StampedPose& pose : rests) pose.T_world_body.translation() *= 1e-6;
  EXPECT_FALSE(evaluate(larger, rests).size_ratio.has_value());
}

TEST(Evaluation, ProtocolNamesTheAlignment) {
  const Trajectory truth = helix(5'000'000, 2001);
  const std::string line = evaluate(truth, truth).protocol;
  EXPECT_EQ(line,
            "SE3-aligned, 2001 of 2001 poses matched with interpolated truth (a sample within "
            "10 ms), completion 100.0 % (10.00 s of truth, longest gap 0.01 s), 10.44 m of path");
}

TEST(Evaluation, PathLengthOfTheMatchedSpanOnly) {
  // Helix of slope 0.3: length sqrt(1.09) per second.
  const Trajectory truth = helix(5'000'000, 2001);
  Trajectory estimate = helix(52'500'000, 100);
  estimate.erase(estimate.begin(), estimate.begin() + 20);
  const double seconds = (99 - 20) * 0.0525;
  EXPECT_NEAR(evaluate(estimate, truth).path_length_m, seconds * std::sqrt(1.09), 1e-4);
}

TEST(Evaluation, HalfTheTruthIsHalfComplete) {
  const Trajectory truth = helix(5'000'000, 2001);  // 10 s
  Trajectory half = helix(50'000'000, 201);
  half.erase(half.begin() + 151, half.end());   // until 7.5 s …
  half.erase(half.begin(), half.begin() + 50);  // … from 2.5 s on
  const Evaluation by_time = evaluate(half, truth);
  EXPECT_DOUBLE_EQ(by_time.completion, 0.5);
  EXPECT_NE(by_time.protocol.find("completion 50.0 % (10.00 s of truth"), std::string::npos)
      << by_time.protocol;
  EvaluationOptions by_number;
  by_number.stamps = Stamps::pose_number;
  Trajectory first_half = truth;
  first_half.resize(1000);
  const Trajectory numbered(truth.begin(), truth.begin() + 2000);
  EXPECT_DOUBLE_EQ(evaluate(first_half, numbered, by_number).completion, 0.5);
}

TEST(Evaluation, TheLongestGapIsThatBetweenTwoPoses) {
  const Trajectory truth = helix(5'000'000, 2001);
  Trajectory estimate = helix(50'000'000, 201);
  estimate.erase(estimate.begin() + 40, estimate.begin() + 59);
  EXPECT_DOUBLE_EQ(evaluate(estimate, truth).longest_gap_s.value(), 1.0);
  EXPECT_DOUBLE_EQ(evaluate(estimate, truth).completion, 1.0);
}

TEST(Evaluation, NothingMatched) {
  const Trajectory truth = helix(5'000'000, 10);
  const Trajectory later{{1'000'000'000'000, Eigen::Isometry3d::Identity()}};
  testing::expect_input_error([&] { evaluate(later, truth); },
                              {"none of the 1", "10 ms", "(from 0.000 to 0.045 s)"});
  testing::expect_input_error([&] { evaluate({truth[0], truth[1]}, truth); }, {"at least 3"});
}

TEST(Evaluation, RecordedPathHasItsKnownLength) {
  const auto folder = testing::recorded_data() / "euroc" / "MH_01_easy_t05_t20";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const Dataset data = open_asl(folder);
  const Trajectory truth = to_trajectory(data.ground_truth);
  Trajectory at_frames;
  for (const FrameRef& frame : data.frames)
    at_frames.push_back({frame.t_ns, Eigen::Isometry3d::Identity()});
  EvaluationOptions options;
  options.alignment = Alignment::none;
  const Evaluation result = evaluate(at_frames, truth, options);
  EXPECT_EQ(result.matched, 300u);
  EXPECT_NEAR(result.path_length_m, 5.4, 0.1);
}

}  // namespace
}  // namespace leviosim::traces
