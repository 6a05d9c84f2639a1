#include "traces/synthesis/imu_synthesis.h"

#include <cmath>

namespace leviosim::traces {

ImuSample ideal_imu(const MotionState& state, std::int64_t t_ns) {
  const Eigen::Vector3d gravity(0, 0, -kGravity);
  ImuSample sample;
  sample.t_ns = t_ns;
  sample.gyro = state.angular_velocity;
  sample.accel = state.T_world_body.linear().transpose() * (state.acceleration - gravity);
  return sample;
}

ImuSynthesizer::ImuSynthesizer(const ImuModel& model, std::uint64_t seed)
    : model_(model), rng_(seed) {
  bias_gyro_ = draw(kTurnOnBiasGyro);
  bias_accel_ = draw(kTurnOnBiasAccel);
}

Eigen::Vector3d ImuSynthesizer::draw(double deviation) {
  const double x = rng_.normal();
  const double y = rng_.normal();
  const double z = rng_.normal();
  return deviation * Eigen::Vector3d(x, y, z);
}

ImuSample ImuSynthesizer::measure(const MotionState& state, std::int64_t t_ns) {
  const double root_rate = std::sqrt(model_.rate_hz);
  if (!first_) {
    bias_gyro_ += draw(model_.gyro_random_walk / root_rate);
    bias_accel_ += draw(model_.accel_random_walk / root_rate);
  }
  first_ = false;
  ImuSample sample = ideal_imu(state, t_ns);
  sample.gyro += bias_gyro_ + draw(model_.gyro_noise_density * root_rate);
  sample.accel += bias_accel_ + draw(model_.accel_noise_density * root_rate);
  return sample;
}

ImuTrack record_imu(const Motion& motion, ImuSynthesizer* imu, std::int64_t origin_ns,
                    const std::vector<std::int64_t>& stamps_ns) {
  ImuTrack track;
  for (const std::int64_t t_ns : stamps_ns) {
    const MotionState state = motion.at(static_cast<double>(t_ns - origin_ns) * 1e-9);
    track.samples.push_back(imu != nullptr ? imu->measure(state, t_ns) : ideal_imu(state, t_ns));
    GroundTruthPose truth;
    truth.t_ns = t_ns;
    truth.T_world_body = state.T_world_body;
    truth.velocity = state.velocity;
    if (imu != nullptr) {
      truth.bias_gyro = imu->bias_gyro();
      truth.bias_accel = imu->bias_accel();
    }
    track.truth.push_back(truth);
  }
  return track;
}

}  // namespace leviosim::traces
