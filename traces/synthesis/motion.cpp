#include "traces/synthesis/motion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sim/base/angles.h"
#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

struct SineRow {
  double amplitude, frequency_hz;
};
struct ChannelRow {
  double offset;
  std::array<SineRow, 2> sines;
};

constexpr std::array<ChannelRow, 6> kChannels{{
    {0.0, {{{0.90, 0.090}, {0.25, 0.230}}}},  // x [m]
    {0.0, {{{0.60, 0.110}, {0.20, 0.290}}}},  // y [m]
    {1.6, {{{0.30, 0.170}, {0.10, 0.410}}}},  // z [m]
    {0.0, {{{0.80, 0.060}, {0.33, 0.270}}}},  // yaw [rad]
    {0.0, {{{0.12, 0.310}, {0.03, 0.730}}}},  // pitch [rad]
    {0.0, {{{0.10, 0.370}, {0.03, 0.610}}}},  // roll [rad]
}};

/// Body axes in a frame that has x forward, y left, z up: the columns are up, right, forward.
Eigen::Matrix3d body_in_level_frame() {
  Eigen::Matrix3d rotation;
  rotation << 0, 0, 1,  //
      0, -1, 0,         //
      1, 0, 0;
  return rotation;
}

/// R = Rz(yaw) Ry(pitch) Rx(roll), and its angular velocity in the rotated frame.
struct Attitude {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d angular_velocity;
};

Attitude attitude(const Derivatives& yaw, const Derivatives& pitch, const Derivatives& roll) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  const AngleAxisd about_z(yaw.value, Vector3d::UnitZ());
  const AngleAxisd about_y(pitch.value, Vector3d::UnitY());
  const AngleAxisd about_x(roll.value, Vector3d::UnitX());
  const Eigen::Matrix3d roll_t = about_x.toRotationMatrix().transpose();
  const Eigen::Matrix3d pitch_t = about_y.toRotationMatrix().transpose();
  Attitude result;
  result.rotation = (about_z * about_y * about_x).toRotationMatrix();
  result.angular_velocity =
      roll.first * Vector3d::UnitX() +
      roll_t * (pitch.first * Vector3d::UnitY() + pitch_t * (yaw.first * Vector3d::UnitZ()));
  return result;
}

}  // namespace

HandHeldFlight::HandHeldFlight(std::uint64_t seed) {
  Rng rng(seed);
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    channels_[i].offset = kChannels[i].offset;
    for (std::size_t j = 0; j < channels_[i].sines.size(); ++j) {
      const SineRow& row = kChannels[i].sines[j];
      channels_[i].sines[j] = {row.amplitude, base::kTwoPi * row.frequency_hz,
                               rng.uniform(0, base::kTwoPi)};
    }
  }
}

Derivatives HandHeldFlight::path_parameter(double t_s) {
  // ds/dt = 35 u⁴ - 84 u⁵ + 70 u⁶ - 20 u⁷ with u = (t - rest) / start, which is 0 and flat at
  // u = 0, and 1 and flat at u = 1.
  const double u = std::clamp((t_s - kRestS) / kStartS, 0.0, 1.0);
  const double u3 = u * u * u;
  const double u4 = u3 * u;
  Derivatives s;
  s.value = kStartS * u4 * u * (7 + u * (-14 + u * (10 - 2.5 * u)));
  s.first = u4 * (35 + u * (-84 + u * (70 - 20 * u)));
  s.second = 140 * u3 * (1 - u) * (1 - u) * (1 - u) / kStartS;
  if (t_s > kRestS + kStartS) s.value += t_s - (kRestS + kStartS);
  return s;
}

Derivatives HandHeldFlight::evaluate(const Channel& channel, const Derivatives& s) {
  Derivatives by_s{channel.offset, 0, 0};
  for (const Sine& sine : channel.sines) {
    const double w = sine.angular_frequency;
    const double angle = w * s.value + sine.phase;
    by_s.value += sine.amplitude * std::sin(angle);
    by_s.first += sine.amplitude * w * std::cos(angle);
    by_s.second -= sine.amplitude * w * w * std::sin(angle);
  }
  return {by_s.value, by_s.first * s.first,
          by_s.second * s.first * s.first + by_s.first * s.second};
}

MotionState HandHeldFlight::at(double t_s) const {
  const Derivatives s = path_parameter(t_s);
  std::array<Derivatives, 6> c;
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = evaluate(channels_[i], s);
  const Attitude level = attitude(c[3], c[4], c[5]);
  const Eigen::Matrix3d level_body = body_in_level_frame();

  MotionState state;
  state.T_world_body.linear() = level.rotation * level_body;
  state.T_world_body.translation() = Eigen::Vector3d(c[0].value, c[1].value, c[2].value);
  state.velocity = Eigen::Vector3d(c[0].first, c[1].first, c[2].first);
  state.acceleration = Eigen::Vector3d(c[0].second, c[1].second, c[2].second);
  state.angular_velocity = level_body.transpose() * level.angular_velocity;
  return state;
}

}  // namespace leviosim::traces
