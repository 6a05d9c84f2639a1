#include "traces/synthesis/motion.h"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "sim/base/check.h"
#include "sim/base/units.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/imu_synthesis.h"
#include "traces/synthesis/recorded_motion.h"
#include "traces/synthesis/smoothing_spline.h"

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

namespace {

constexpr Eigen::Index kColumns = 7;

std::vector<double> times(std::span<const GroundTruthPose> poses, std::int64_t origin_ns) {
  std::vector<double> result;
  for (const GroundTruthPose& pose : poses)
    result.push_back(static_cast<double>(pose.t_ns - origin_ns) * 1e-9);
  return result;
}

/// Of the two quaternions of each attitude, the one nearer to that of the pose before.
Eigen::MatrixXd samples(std::span<const GroundTruthPose> poses) {
  Eigen::MatrixXd result(static_cast<Eigen::Index>(poses.size()), kColumns);
  Eigen::Vector4d before = Eigen::Vector4d::Zero();
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    const Eigen::Isometry3d& pose = poses[static_cast<std::size_t>(i)].T_world_body;
    Eigen::Vector4d q = Eigen::Quaterniond(pose.linear()).coeffs();
    if (q.dot(before) < 0) q = -q;
    before = q;
    result.row(i) << pose.translation().transpose(), q.transpose();
  }
  return result;
}

}  // namespace

RecordedMotion::RecordedMotion(std::span<const GroundTruthPose> poses, std::int64_t origin_ns,
                               double half_gain_hz)
    : spline_(times(poses, origin_ns), samples(poses), half_gain_hz) {}

MotionState RecordedMotion::at(double t_s) const {
  const SplineState spline = spline_.at(t_s);
  const Eigen::Vector4d coefficients = spline.value.tail<4>();
  const Eigen::Vector4d rate = spline.first.tail<4>();
  const double length = coefficients.norm();
  const Eigen::Quaterniond q(Eigen::Vector4d(coefficients / length));
  const Eigen::Quaterniond q_rate(Eigen::Vector4d(rate / length));
  MotionState state;
  state.T_world_body.linear() = q.toRotationMatrix();
  state.T_world_body.translation() = spline.value.head<3>();
  state.velocity = spline.first.head<3>();
  state.acceleration = spline.second.head<3>();
  // The part of the rate along q, which changes only its length, ends up in the real part.
  state.angular_velocity = 2 * (q.conjugate() * q_rate).vec();
  return state;
}

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Q of Green and Silverman (n x n-2): its transpose takes second differences.
Sparse second_differences(const Eigen::VectorXd& steps) {
  const Eigen::Index inner = steps.size() - 1;
  Triplets entries;
  for (Eigen::Index j = 0; j < inner; ++j) {
    entries.emplace_back(j, j, 1 / steps[j]);
    entries.emplace_back(j + 1, j, -1 / steps[j] - 1 / steps[j + 1]);
    entries.emplace_back(j + 2, j, 1 / steps[j + 1]);
  }
  Sparse q(inner + 2, inner);
  q.setFromTriplets(entries.begin(), entries.end());
  return q;
}

/// R of Green and Silverman (n-2 x n-2): g R g is the integral of the squared curvature.
Sparse curvature_products(const Eigen::VectorXd& steps) {
  const Eigen::Index inner = steps.size() - 1;
  Triplets entries;
  for (Eigen::Index j = 0; j < inner; ++j) {
    entries.emplace_back(j, j, (steps[j] + steps[j + 1]) / 3);
    if (j + 1 == inner) break;
    entries.emplace_back(j, j + 1, steps[j + 1] / 6);
    entries.emplace_back(j + 1, j, steps[j + 1] / 6);
  }
  Sparse r(inner, inner);
  r.setFromTriplets(entries.begin(), entries.end());
  return r;
}

}  // namespace

SmoothingSpline::SmoothingSpline(std::vector<double> times, Eigen::MatrixXd samples,
                                 double half_gain_hz)
    : times_(std::move(times)), values_(std::move(samples)) {
  check(times_.size() >= 2, "SmoothingSpline: at least two samples");
  check(half_gain_hz > 0, "SmoothingSpline: half_gain_hz above 0");
  check_equal(times_.size(), static_cast<std::size_t>(values_.rows()), "SmoothingSpline: samples");
  const double period_s = (times_.back() - times_.front()) / static_cast<double>(times_.size() - 1);
  // The penalty weighs an integral against a sum, hence the sampling period.
  fit(std::isinf(half_gain_hz) ? 0 : 1 / (period_s * std::pow(base::kTwoPi * half_gain_hz, 4)));
}

void SmoothingSpline::fit(double alpha) {
  curvatures_.setZero(values_.rows(), values_.cols());
  const Eigen::Index inner = values_.rows() - 2;
  if (inner == 0) return;
  const Eigen::Map<const Eigen::VectorXd> t(times_.data(), values_.rows());
  const Eigen::VectorXd steps = t.tail(inner + 1) - t.head(inner + 1);
  check(steps.minCoeff() > 0, "SmoothingSpline: times rise");
  const Sparse q = second_differences(steps);
  const Sparse normal = curvature_products(steps) + alpha * Sparse(q.transpose() * q);
  const Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>> solver(normal);
  check(solver.info() == Eigen::Success, "SmoothingSpline: positive definite");
  const Eigen::MatrixXd differences = q.transpose() * values_;
  const Eigen::MatrixXd inner_curvatures = solver.solve(differences);
  values_ -= alpha * (q * inner_curvatures);
  curvatures_.middleRows(1, inner) = inner_curvatures;
}

SplineState SmoothingSpline::at(double t_s) const {
  const auto right = std::upper_bound(times_.begin() + 1, times_.end() - 1, t_s);
  const Eigen::Index i = right - times_.begin() - 1;
  const double from = times_[static_cast<std::size_t>(i)];
  const double h = *right - from;
  const double inside = std::clamp(t_s, from, *right);
  const double b = (inside - from) / h;
  const double a = 1 - b;
  const auto row = [](const Eigen::MatrixXd& m, Eigen::Index r) -> Eigen::VectorXd {
    return m.row(r);
  };
  const Eigen::VectorXd v0 = row(values_, i), v1 = row(values_, i + 1);
  const Eigen::VectorXd c0 = row(curvatures_, i), c1 = row(curvatures_, i + 1);
  SplineState state;
  state.first = (v1 - v0) / h + h / 6 * ((1 - 3 * a * a) * c0 + (3 * b * b - 1) * c1);
  state.value = a * v0 + b * v1 + h * h / 6 * (a * (a * a - 1) * c0 + b * (b * b - 1) * c1) +
                (t_s - inside) * state.first;
  state.second = a * c0 + b * c1;
  return state;
}

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
