// What an IMU reads along a motion: angular velocity and specific force (acceleration minus
// gravity) in the body frame, plus the errors of an ImuModel: white noise of density n becomes a
// standard deviation n √rate per sample, the bias walks by w / √rate per sample. Biases at turn-on
// are normal with the deviations below, the size of those in the ground truth of EuRoC's V1_02
// (up to 0.076 rad/s and 0.10 m/s²). Left out: quantisation, saturation, time jitter.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <vector>

#include "traces/datasets/dataset.h"
#include "traces/datasets/imu_model.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/motion.h"

namespace leviosim::traces {

constexpr double kGravity = 9.81;          ///< [m/s²], towards -z of the world
constexpr double kTurnOnBiasGyro = 0.03;   ///< standard deviation per axis [rad/s]
constexpr double kTurnOnBiasAccel = 0.06;  ///< standard deviation per axis [m/s²]

/// The reading of a perfect IMU.
ImuSample ideal_imu(const MotionState& state, std::int64_t t_ns);

/// An imperfect IMU. Stateful: call measure() once per sample, in order of time.
class ImuSynthesizer {
 public:
  ImuSynthesizer(const ImuModel& model, std::uint64_t seed);

  /// The ideal reading plus the present biases plus noise. The biases walk before each sample but
  /// the first.
  ImuSample measure(const MotionState& state, std::int64_t t_ns);

  /// The biases contained in the last sample.
  const Eigen::Vector3d& bias_gyro() const { return bias_gyro_; }
  const Eigen::Vector3d& bias_accel() const { return bias_accel_; }

 private:
  Eigen::Vector3d draw(double deviation);

  ImuModel model_;
  Rng rng_;
  bool first_ = true;
  Eigen::Vector3d bias_gyro_;
  Eigen::Vector3d bias_accel_;
};

/// Samples of an IMU along a motion and the truth at the same times.
struct ImuTrack {
  std::vector<ImuSample> samples;
  std::vector<GroundTruthPose> truth;
};

/// `imu` may be null for a perfect IMU. Time 0 of the motion is `origin_ns`.
ImuTrack record_imu(const Motion& motion, ImuSynthesizer* imu, std::int64_t origin_ns,
                    const std::vector<std::int64_t>& stamps_ns);

}  // namespace leviosim::traces
