// The motion behind sampled poses against the motion that was sampled.
#include "traces/synthesis/recorded_motion.h"
#include "traces/synthesis/imu_synthesis.h"
#include "traces/synthesis/motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/traces/imu_integration.h"
#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

constexpr std::int64_t kOriginNs = 1'403'636'580'838'555'392;
constexpr std::int64_t kPeriodNs = 5'000'000;

double seconds(std::int64_t t_ns) { return static_cast<double>(t_ns - kOriginNs) * 1e-9; }

/// 8 s of poses at 200 Hz with jittering stamps, as a recording has them: velocities and biases
/// that nobody may use, and numbers rounded to `resolution` (0: exact).
std::vector<GroundTruthPose> recorded(const Motion& motion, double resolution) {
  const auto round = [resolution](double value) {
    return resolution > 0 ? std::round(value / resolution) * resolution : value;
  };
  Rng rng(5);
  std::vector<GroundTruthPose> poses;
  for (int i = 0; i <= 1600; ++i) {
    GroundTruthPose pose;
    pose.t_ns = kOriginNs + i * kPeriodNs + rng.below(257) - 128;
    const Eigen::Isometry3d exact = motion.at(seconds(pose.t_ns)).T_world_body;
    Eigen::Quaterniond q(exact.linear());
    if (rng.chance(0.5)) q.coeffs() = -q.coeffs();
    q.coeffs() = q.coeffs().unaryExpr(round);
    pose.T_world_body = Eigen::Translation3d(exact.translation().unaryExpr(round)) * q.normalized();
    pose.velocity.setConstant(1e3);
    pose.bias_gyro.setConstant(1e3);
    poses.push_back(pose);
  }
  return poses;
}

struct Errors {
  double position = 0, rotation = 0, velocity = 0, acceleration = 0, angular_velocity = 0;
};

/// The largest errors in the middle between samples, away from the ends.
Errors worst(const Motion& motion, const Motion& truth) {
  Errors errors;
  for (int i = 40; i < 1560; ++i) {
    const double t_s = (i + 0.5) * 1e-9 * kPeriodNs;
    const MotionState a = motion.at(t_s), b = truth.at(t_s);
    const auto raise = [](double& most, double value) { most = std::max(most, value); };
    raise(errors.position, (a.T_world_body.translation() - b.T_world_body.translation()).norm());
    raise(errors.rotation, Eigen::Quaterniond(a.T_world_body.linear())
                               .angularDistance(Eigen::Quaterniond(b.T_world_body.linear())));
    raise(errors.velocity, (a.velocity - b.velocity).norm());
    raise(errors.acceleration, (a.acceleration - b.acceleration).norm());
    raise(errors.angular_velocity, (a.angular_velocity - b.angular_velocity).norm());
  }
  return errors;
}

TEST(RecordedMotion, MeetsTheMotionBetweenItsSamples) {
  const HandHeldFlight truth(2);
  const Errors errors = worst(RecordedMotion(recorded(truth, 0), kOriginNs), truth);
  EXPECT_LT(errors.position, 1e-8);
  EXPECT_LT(errors.rotation, 1e-7);
  EXPECT_LT(errors.velocity, 1e-6);
  EXPECT_LT(errors.acceleration, 1e-3);
  EXPECT_LT(errors.angular_velocity, 1e-5);
}

TEST(RecordedMotion, TurnsOnThroughHalfATurn) {
  // There the quaternion of a rotation matrix changes its sign.
  std::vector<GroundTruthPose> poses;
  for (int i = 0; i < 800; ++i) {
    GroundTruthPose pose;
    pose.t_ns = kOriginNs + i * kPeriodNs;
    pose.T_world_body.linear() =
        Eigen::AngleAxisd(2 * seconds(pose.t_ns), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    poses.push_back(pose);
  }
  const RecordedMotion motion(poses, kOriginNs);
  for (int i = 40; i < 760; ++i) {
    const Eigen::Vector3d turning =
        motion.at(seconds(poses[0].t_ns + i * kPeriodNs)).angular_velocity;
    EXPECT_LT((turning - Eigen::Vector3d(0, 0, 2)).norm(), 1e-4) << i;
  }
}

TEST(RecordedMotion, MeetsEveryRecordedPose) {
  const std::vector<GroundTruthPose> poses = recorded(HandHeldFlight(3), 1e-6);
  const RecordedMotion motion(poses, kOriginNs);
  for (const GroundTruthPose& pose : poses) {
    const Eigen::Isometry3d at = motion.at(seconds(pose.t_ns)).T_world_body;
    EXPECT_TRUE(at.isApprox(pose.T_world_body, 1e-12));
  }
}

TEST(RecordedMotion, SmoothingTakesAwayTheRoundingOfTheRecording) {
  const HandHeldFlight truth(2);
  const std::vector<GroundTruthPose> poses = recorded(truth, 1e-6);
  const Errors rough = worst(RecordedMotion(poses, kOriginNs), truth);
  const Errors smooth = worst(RecordedMotion(poses, kOriginNs, RecordedMotion::kSmoothHz), truth);
  EXPECT_GT(rough.acceleration, 0.05) << "as much as the noise of an accelerometer";
  EXPECT_LT(smooth.acceleration, 0.01);
  EXPECT_LT(smooth.angular_velocity, 5e-4);
  EXPECT_LT(smooth.position, 1e-4);
  EXPECT_LT(smooth.rotation, 1e-4);
}

TEST(RecordedMotion, AnIdealImuIntegratesBackToThePath) {
  const RecordedMotion motion(recorded(HandHeldFlight(4), 1e-6), kOriginNs,
                              RecordedMotion::kSmoothHz);
  std::vector<std::int64_t> stamps;
  for (int i = 0; i <= 3000; ++i) stamps.push_back(kOriginNs + kPeriodNs / 2 * i);
  const ImuTrack track = record_imu(motion, nullptr, kOriginNs, stamps);
  const testing::InertialState end = testing::integrate(track);
  const GroundTruthPose& truth = track.truth.back();
  EXPECT_LT((end.p - truth.T_world_body.translation()).norm(), 1e-4);
  EXPECT_LT((end.v - truth.velocity).norm(), 1e-4);
  EXPECT_LT(
      Eigen::Quaterniond(end.q).angularDistance(Eigen::Quaterniond(truth.T_world_body.linear())),
      1e-5);
}

TEST(RecordedMotion, RecordedFlightsAgreeWithTheirGyroscope) {
  const auto folder = testing::recorded_data() / "euroc_motion" / "V1_02_medium";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP()
        << "no recorded motion: set LEVIOSIM_DATA to the folder that contains euroc_motion/";
  const MotionRecord record = open_motion(folder);
  const std::int64_t origin_ns = record.ground_truth.front().t_ns;
  const RecordedMotion exact(record.ground_truth, origin_ns);
  const RecordedMotion smooth(record.ground_truth, origin_ns, RecordedMotion::kSmoothHz);
  const Eigen::Vector3d bias = record.ground_truth.front().bias_gyro;
  double squares = 0, signal = 0, furthest = 0;
  int count = 0;
  for (const ImuSample& sample : record.imu) {
    if (sample.t_ns < origin_ns || sample.t_ns > record.ground_truth.back().t_ns) continue;
    const double t_s = static_cast<double>(sample.t_ns - origin_ns) * 1e-9;
    const MotionState state = smooth.at(t_s);
    squares += (sample.gyro - bias - state.angular_velocity).squaredNorm();
    signal += state.angular_velocity.squaredNorm();
    furthest = std::max(
        furthest,
        (state.T_world_body.translation() - exact.at(t_s).T_world_body.translation()).norm());
    ++count;
  }
  ASSERT_GT(count, 10'000);
  EXPECT_GT(std::sqrt(signal / count), 0.3) << "it turns";
  EXPECT_LT(std::sqrt(squares / count), 0.1) << "rotor vibrations are not in the ground truth";
  EXPECT_LT(furthest, 1e-3) << "smoothing stays on the path";
}

}  // namespace
}  // namespace leviosim::traces
