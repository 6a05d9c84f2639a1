// Ideal readings must integrate back to the path; errors must have the statistics of the model.
#include "traces/synthesis/imu_synthesis.h"
#include "traces/synthesis/motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/traces/imu_integration.h"
#include "traces/datasets/euroc_sensors.h"

namespace leviosim::traces {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

class Rest : public Motion {
 public:
  MotionState at(double) const override {
    MotionState state;
    state.T_world_body.linear() =
        Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    return state;
  }
};

std::vector<std::int64_t> grid(std::int64_t step_ns, int count) {
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < count; ++i) stamps.push_back(1'000'000'000'000 + i * step_ns);
  return stamps;
}

TEST(ImuSynthesis, IdealReadingsIntegrateToTheTruth) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const HandHeldFlight motion(seed);
    const auto stamps = grid(2'500'000, 8001);  // 20 s
    const ImuTrack track = record_imu(motion, nullptr, stamps.front(), stamps);
    const testing::InertialState end = testing::integrate(track);
    const GroundTruthPose& truth = track.truth.back();
    EXPECT_LT((end.p - truth.T_world_body.translation()).norm(), 1e-6);
    EXPECT_LT((end.v - truth.velocity).norm(), 1e-7);
    EXPECT_LT(Quaterniond(end.q).angularDistance(Quaterniond(truth.T_world_body.linear())), 1e-7);
    EXPECT_EQ(truth.bias_gyro, Vector3d::Zero());
  }
}

TEST(ImuSynthesis, AtRestItFeelsGravityUpwards) {
  const MotionState state = Rest().at(0);
  const ImuSample sample = ideal_imu(state, 5);
  EXPECT_EQ(sample.t_ns, 5);
  EXPECT_TRUE((state.T_world_body.linear() * sample.accel).isApprox(Vector3d(0, 0, kGravity)));
  EXPECT_EQ(sample.gyro, Vector3d::Zero());
}

TEST(ImuSynthesis, WhiteNoiseHasTheDensityOfTheModel) {
  ImuModel model = euroc_imu0();
  model.gyro_random_walk = model.accel_random_walk = 0;
  ImuSynthesizer imu(model, 4);
  const auto stamps = grid(5'000'000, 20'001);
  const ImuTrack track = record_imu(Rest(), &imu, stamps.front(), stamps);
  const ImuSample ideal = ideal_imu(Rest().at(0), 0);
  double gyro = 0, accel = 0;
  for (std::size_t i = 0; i < track.samples.size(); ++i) {
    gyro += (track.samples[i].gyro - ideal.gyro - track.truth[i].bias_gyro).squaredNorm();
    accel += (track.samples[i].accel - ideal.accel - track.truth[i].bias_accel).squaredNorm();
  }
  const double count = 3.0 * static_cast<double>(track.samples.size());
  EXPECT_NEAR(std::sqrt(gyro / count) / (1.6968e-4 * std::sqrt(200)), 1, 0.02);
  EXPECT_NEAR(std::sqrt(accel / count) / (2e-3 * std::sqrt(200)), 1, 0.02);
  EXPECT_EQ(track.truth.front().bias_gyro, track.truth.back().bias_gyro) << "no walk was asked for";
}

TEST(ImuSynthesis, BiasesStartAndWalkAsTheModelSays) {
  constexpr int kFlights = 600;
  const auto stamps = grid(5'000'000, 401);  // 2 s
  double start_gyro = 0, start_accel = 0, walk_gyro = 0, walk_accel = 0;
  for (int i = 0; i < kFlights; ++i) {
    ImuSynthesizer imu(euroc_imu0(), static_cast<std::uint64_t>(i));
    const ImuTrack track = record_imu(Rest(), &imu, stamps.front(), stamps);
    const GroundTruthPose& a = track.truth.front();
    const GroundTruthPose& b = track.truth.back();
    start_gyro += a.bias_gyro.squaredNorm() / (3 * kFlights);
    start_accel += a.bias_accel.squaredNorm() / (3 * kFlights);
    walk_gyro += (b.bias_gyro - a.bias_gyro).squaredNorm() / (3 * kFlights);
    walk_accel += (b.bias_accel - a.bias_accel).squaredNorm() / (3 * kFlights);
  }
  // 1800 values: the standard deviation is known to 1.7 % (one sigma).
  EXPECT_NEAR(std::sqrt(start_gyro) / kTurnOnBiasGyro, 1, 0.07);
  EXPECT_NEAR(std::sqrt(start_accel) / kTurnOnBiasAccel, 1, 0.07);
  EXPECT_NEAR(std::sqrt(walk_gyro) / (1.9393e-5 * std::sqrt(2.0)), 1, 0.07);
  EXPECT_NEAR(std::sqrt(walk_accel) / (3e-3 * std::sqrt(2.0)), 1, 0.07);
}

}  // namespace
}  // namespace leviosim::traces
