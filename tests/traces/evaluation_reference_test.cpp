// The evaluation against an independent one: linear scans, Eigen's Umeyama, the yaw from sums of
// squares, and all pairs of poses.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/rng.h"
#include "traces/trajectories/association.h"
#include "traces/trajectories/evaluation.h"
#include "traces/trajectories/trajectory_alignment.h"
#include "traces/trajectories/trajectory_errors.h"

namespace leviosim::traces {
namespace {

constexpr double kTolerance = 1e-9;

struct Flight {
  Trajectory estimate;
  Trajectory truth;
};

/// A drifting, noisy, scaled estimate of the truth at `stamps`, in a world of its own.
Trajectory spoiled(const Trajectory& truth, const std::vector<std::int64_t>& stamps,
                   std::uint64_t seed) {
  Rng rng(seed);
  const Eigen::Isometry3d world =
      Eigen::Translation3d(5, -3, 2) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 2) / 3);
  const auto noise = [&](double size) -> Eigen::Vector3d {
    const double x = rng.normal();
    const double y = rng.normal();
    return size * Eigen::Vector3d(x, y, rng.normal());
  };
  Trajectory estimate;
  Eigen::Vector3d drift = Eigen::Vector3d::Zero();
  for (const MatchedPose& match : associate(
           [&] {
             Trajectory at;
             for (const std::int64_t t : stamps) at.push_back({t, Eigen::Isometry3d::Identity()});
             return at;
           }(),
           truth, INT64_MAX)) {
    drift += noise(0.01);
    Eigen::Isometry3d pose = match.truth;
    pose.translation() = 1.1 * pose.translation() + drift;
    const Eigen::Vector3d turn = noise(0.05);
    pose.linear() =
        pose.linear() * Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    estimate.push_back({match.t_ns, world * pose});
  }
  return estimate;
}

Flight random_flight(std::uint64_t seed) {
  Rng rng(seed);
  Flight flight;
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < 900; ++i) {
    const double s = 0.02 * i;
    const Eigen::Vector3d p(3 * std::cos(s), 2 * std::sin(1.3 * s),
                            0.4 * std::sin(3 * s) + 0.1 * s);
    flight.truth.push_back(
        {20'000'000 * std::int64_t{i},
         Eigen::Translation3d(p) * Eigen::AngleAxisd(0.8 * s, Eigen::Vector3d(0.48, 0.6, 0.64))});
    if (i % 3 == 0)
      stamps.push_back(20'000'000 * std::int64_t{i} +
                       static_cast<std::int64_t>(rng.below(20'000'000)));
  }
  flight.estimate = spoiled(flight.truth, stamps, seed + 100);
  return flight;
}

double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::Quaterniond(a).angularDistance(Eigen::Quaterniond(b)) * 180 / std::numbers::pi;
}

/// The true pose at a time, by looking at every pair of neighbours.
std::optional<Eigen::Isometry3d> true_pose(const Trajectory& truth, std::int64_t t_ns,
                                           std::int64_t max_gap_ns) {
  for (std::size_t i = 0; i + 1 < truth.size(); ++i) {
    const StampedPose& a = truth[i];
    const StampedPose& b = truth[i + 1];
    if (t_ns < a.t_ns || t_ns > b.t_ns) continue;
    if (t_ns - a.t_ns > max_gap_ns && b.t_ns - t_ns > max_gap_ns) return std::nullopt;
    const double s = static_cast<double>(t_ns - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns);
    const Eigen::Matrix3d turn = a.T_world_body.linear().transpose() * b.T_world_body.linear();
    const Eigen::AngleAxisd whole(turn);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = a.T_world_body.translation() +
                         s * (b.T_world_body.translation() - a.T_world_body.translation());
    pose.linear() = a.T_world_body.linear() *
                    Eigen::AngleAxisd(s * whole.angle(), whole.axis()).toRotationMatrix();
    return pose;
  }
  return std::nullopt;
}

struct Reference {
  std::vector<Eigen::Isometry3d> estimate;  ///< aligned
  std::vector<Eigen::Isometry3d> truth;
  std::vector<std::int64_t> t_ns;
  double rmse = 0;
  double mean = 0;
  double max = 0;
  double rotation_rmse_deg = 0;
};

/// Columns are points.
Eigen::Matrix3Xd positions(const std::vector<Eigen::Isometry3d>& poses) {
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) = poses[i].translation();
  return points;
}

Eigen::Matrix4d turned_by(double yaw, const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();
  transform.topLeftCorner<3, 3>() =
      Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  transform.topRightCorner<3, 1>() =
      to.rowwise().mean() - transform.topLeftCorner<3, 3>() * from.rowwise().mean();
  return transform;
}

double squares(const Eigen::Matrix4d& t, const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  return (((t.topLeftCorner<3, 3>() * from).colwise() + t.topRightCorner<3, 1>()) - to)
      .squaredNorm();
}

/// The sum of squares is a constant minus a sinusoid of the yaw, whose phase four values give.
Eigen::Matrix4d best_yaw(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  const auto at = [&](double yaw) { return squares(turned_by(yaw, from, to), from, to); };
  return turned_by(std::atan2(at(-std::numbers::pi / 2) - at(std::numbers::pi / 2),
                              at(std::numbers::pi) - at(0)),
                   from, to);
}

Eigen::Matrix4d best_transform(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to,
                               Alignment alignment) {
  if (alignment == Alignment::none) return Eigen::Matrix4d::Identity();
  if (alignment == Alignment::posyaw) return best_yaw(from, to);
  return Eigen::umeyama(from, to, alignment == Alignment::sim3);
}

Reference reference(const Flight& flight, const EvaluationOptions& options) {
  Reference r;
  for (const StampedPose& pose : flight.estimate) {
    const auto truth = true_pose(flight.truth, pose.t_ns, options.max_gap_ns);
    if (!truth) continue;
    r.estimate.push_back(pose.T_world_body);
    r.truth.push_back(*truth);
    r.t_ns.push_back(pose.t_ns);
  }
  const Eigen::Matrix4d t =
      best_transform(positions(r.estimate), positions(r.truth), options.alignment);
  const double scale = std::cbrt(t.topLeftCorner<3, 3>().determinant());
  for (std::size_t i = 0; i < r.estimate.size(); ++i) {
    Eigen::Isometry3d& pose = r.estimate[i];
    const Eigen::Vector3d p = (t * pose.translation().homogeneous()).head<3>();
    pose.linear() = (t.topLeftCorner<3, 3>() / scale * pose.linear()).eval();
    pose.translation() = p;
    const double error = (p - r.truth[i].translation()).norm();
    const auto n = static_cast<double>(r.truth.size());
    r.rmse += error * error / n;
    r.mean += error / n;
    r.max = std::max(r.max, error);
    r.rotation_rmse_deg += std::pow(angle_between(pose.linear(), r.truth[i].linear()), 2) / n;
  }
  r.rmse = std::sqrt(r.rmse);
  r.rotation_rmse_deg = std::sqrt(r.rotation_rmse_deg);
  return r;
}

/// Length of the true path between two matched poses, walked anew for every pair.
double true_length(const Flight& flight, const Reference& r, std::size_t from, std::size_t to) {
  double length = 0;
  Eigen::Vector3d here = r.truth[from].translation();
  for (const StampedPose& sample : flight.truth) {
    if (sample.t_ns <= r.t_ns[from] || sample.t_ns >= r.t_ns[to]) continue;
    length += (sample.T_world_body.translation() - here).norm();
    here = sample.T_world_body.translation();
  }
  return length + (r.truth[to].translation() - here).norm();
}

struct RelativeReference {
  std::vector<double> percent;
  std::vector<double> deg_per_m;
};

RelativeReference relative_reference(const Flight& flight, const Reference& r, double length_m) {
  RelativeReference errors;
  for (std::size_t i = 0; i < r.truth.size(); ++i)
    for (std::size_t j = i + 1; j < r.truth.size(); ++j) {
      if (true_length(flight, r, i, j) < length_m) continue;
      const Eigen::Matrix4d gt = r.truth[i].matrix().inverse() * r.truth[j].matrix();
      const Eigen::Matrix4d est = r.estimate[i].matrix().inverse() * r.estimate[j].matrix();
      const Eigen::Matrix4d error = gt.inverse() * est;
      errors.percent.push_back(100 * error.topRightCorner<3, 1>().norm() / length_m);
      errors.deg_per_m.push_back(
          angle_between(error.topLeftCorner<3, 3>(), Eigen::Matrix3d::Identity()) / length_m);
      break;
    }
  return errors;
}

void expect_summary(const ErrorSummary& found, std::vector<double> errors) {
  ASSERT_FALSE(errors.empty());
  double sum = 0;
  double squared = 0;
  for (const double e : errors) {
    sum += e;
    squared += e * e;
  }
  const auto n = static_cast<double>(errors.size());
  std::sort(errors.begin(), errors.end());
  const std::size_t half = errors.size() / 2;
  const double median =
      errors.size() % 2 == 1 ? errors[half] : (errors[half - 1] + errors[half]) / 2;
  EXPECT_NEAR(found.mean, sum / n, kTolerance);
  EXPECT_NEAR(found.rmse, std::sqrt(squared / n), kTolerance);
  EXPECT_NEAR(found.median, median, kTolerance);
  EXPECT_NEAR(found.max, errors.back(), kTolerance);
}

void expect_agreement(const Flight& flight, const EvaluationOptions& options,
                      const std::vector<double>& lengths_m) {
  const Evaluation found = evaluate(flight.estimate, flight.truth, options);
  const Reference expected = reference(flight, options);
  SCOPED_TRACE(name_of(options.alignment));
  ASSERT_EQ(found.matched, expected.truth.size());
  EXPECT_NEAR(found.translation.rmse, expected.rmse, kTolerance);
  EXPECT_NEAR(found.translation.mean, expected.mean, kTolerance);
  EXPECT_NEAR(found.translation.max, expected.max, kTolerance);
  EXPECT_NEAR(found.rotation_rmse_deg, expected.rotation_rmse_deg, kTolerance);
  EXPECT_NEAR(found.path_length_m, true_length(flight, expected, 0, expected.truth.size() - 1),
              kTolerance);
  for (const double length : lengths_m) {
    const RelativeErrors relative = relative_errors(found, length);
    const RelativeReference all = relative_reference(flight, expected, length);
    ASSERT_EQ(relative.count, all.percent.size()) << length;
    expect_summary(relative.translation, all.percent);
    expect_summary(relative.rotation_deg_per_m, all.deg_per_m);
  }
}

class EvaluationReference : public ::testing::TestWithParam<Alignment> {};
INSTANTIATE_TEST_SUITE_P(Alignments, EvaluationReference,
                         ::testing::Values(Alignment::none, Alignment::se3, Alignment::sim3,
                                           Alignment::posyaw),
                         [](const auto& name) { return std::string(name_of(name.param)); });

TEST_P(EvaluationReference, AgreesOnRandomFlights) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    EvaluationOptions options;
    options.alignment = GetParam();
    options.max_gap_ns = seed == 3 ? 4'000'000 : 10'000'000;  // the smaller one leaves poses out
    expect_agreement(random_flight(seed), options, {0.5, 2, 10});
  }
}

TEST_P(EvaluationReference, AgreesOnARecordedFlight) {
  const auto folder = testing::recorded_data() / "euroc" / "MH_01_easy_t05_t20";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const Dataset data = open_asl(folder);
  Flight flight;
  flight.truth = to_trajectory(data.ground_truth);
  std::vector<std::int64_t> stamps;
  for (const FrameRef& frame : data.frames) stamps.push_back(frame.t_ns);
  flight.estimate = spoiled(flight.truth, stamps, 9);
  EvaluationOptions options;
  options.alignment = GetParam();
  expect_agreement(flight, options, {1, 4});
}

TEST(EvaluationProperty, PosYawTakesAwayYawAndTranslationAndNothingElse) {
  const Flight flight = random_flight(4);
  EvaluationOptions options;
  options.alignment = Alignment::posyaw;
  const auto rmse_after = [&](const Eigen::Isometry3d& by) {
    Trajectory estimate = flight.estimate;
    for (StampedPose& pose : estimate) pose.T_world_body = by * pose.T_world_body;
    return evaluate(estimate, flight.truth, options);
  };
  const Evaluation before = rmse_after(Eigen::Isometry3d::Identity());
  const Evaluation turned = rmse_after(Eigen::Translation3d(-7, 1, 30) *
                                       Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitZ()));
  EXPECT_NEAR(turned.translation.rmse, before.translation.rmse, kTolerance);
  EXPECT_NEAR(turned.rotation_rmse_deg, before.rotation_rmse_deg, 1e-7);
  const Evaluation rolled =
      rmse_after(Eigen::Isometry3d(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX())));
  EXPECT_GT(std::abs(rolled.translation.rmse - before.translation.rmse), 1e-3);
  EXPECT_GT(std::abs(rolled.rotation_rmse_deg - before.rotation_rmse_deg), 1e-1);
}

TEST(EvaluationProperty, Sim3TakesAwayTheScaleAlsoOfRelativeErrors) {
  const Flight flight = random_flight(5);
  Trajectory scaled = flight.estimate;
  for (StampedPose& pose : scaled) pose.T_world_body.translation() *= 3.7;
  EvaluationOptions options;
  options.alignment = Alignment::sim3;
  const Evaluation a = evaluate(flight.estimate, flight.truth, options);
  const Evaluation b = evaluate(scaled, flight.truth, options);
  EXPECT_NEAR(a.translation.rmse, b.translation.rmse, kTolerance);
  EXPECT_NEAR(a.alignment.scale, 3.7 * b.alignment.scale, kTolerance);
  EXPECT_NEAR(relative_errors(a, 2).translation.rmse, relative_errors(b, 2).translation.rmse, 1e-8);
  options.alignment = Alignment::se3;
  const Evaluation rigid = evaluate(scaled, flight.truth, options);
  EXPECT_GT(relative_errors(rigid, 2).translation.rmse, 100);
}

}  // namespace
}  // namespace leviosim::traces
