// How a body moves: the pose and its exact derivatives at any time, the source of ground truth and
// of what an ideal IMU feels.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "traces/datasets/dataset.h"
#include "traces/datasets/rng.h"

namespace leviosim::traces {

// Natural cubic smoothing splines through samples at any rising times (Reinsch, "Smoothing by
// spline functions", 1967; Green and Silverman, "Nonparametric Regression and Generalized Linear
// Models", 1994, ch. 2): of all curves the one that minimises
//   sum (y_i - g(t_i))² + alpha ∫ g''(t)² dt,
// a cubic between samples with two continuous derivatives, and zero curvature at both ends. With
// alpha = 0 it interpolates. For evenly spaced samples it is a zero-phase low-pass with the gain
// 1 / (1 + (f / f_half)⁴), which is how alpha is chosen here.

/// Value and derivatives with respect to time, one entry per column of the samples.
struct SplineState {
  Eigen::VectorXd value;
  Eigen::VectorXd first;
  Eigen::VectorXd second;
};

class SmoothingSpline {
 public:
  static constexpr double kInterpolate = std::numeric_limits<double>::infinity();

  /// `times` [s] rise strictly; row i of `samples` belongs to times[i]; at least two.
  /// `half_gain_hz` is the frequency f_half above, or kInterpolate.
  SmoothingSpline(std::vector<double> times, Eigen::MatrixXd samples,
                  double half_gain_hz = kInterpolate);

  /// At any time; beyond the ends the spline goes on along straight lines.
  SplineState at(double t_s) const;

 private:
  /// Solves for the curvatures and moves the values onto the spline.
  void fit(double alpha);

  std::vector<double> times_;
  Eigen::MatrixXd values_;      // of the spline at the times
  Eigen::MatrixXd curvatures_;  // its second derivatives there
};

/// At one time. World frame: z up. Body frame: that of the IMU.
struct MotionState {
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();  ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();              ///< in the world [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();          ///< in the world [m/s²]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();      ///< in the body [rad/s]
};

class Motion {
 public:
  virtual ~Motion() = default;
  /// The state at a time in seconds; any time is valid.
  virtual MotionState at(double t_s) const = 0;
};

/// A value and its first two derivatives with respect to time.
struct Derivatives {
  double value = 0;
  double first = 0;
  double second = 0;
};

/// A hand-held flight through the middle of make_room(). Position and yaw, pitch, roll are each a
/// sum of two sines of a path parameter s(t) that rests at 0 until `kRestS`, then gets going within
/// `kStartS` along a polynomial with three continuous derivatives, and from then on runs with time.
/// All derivatives are analytic. The phases follow from the seed. By construction |x| <= 1.15 m,
/// |y| <= 0.8 m, 1.2 m <= z <= 2.0 m; typically 0.6 m/s and 30 °/s, at most 1.31 m/s and 60 °/s.
///
/// Body axes are EuRoC's: x up, y right, z forward when yaw, pitch and roll are zero, so that the
/// camera of euroc_cam0() looks ahead along the world's x axis.
class HandHeldFlight : public Motion {
 public:
  static constexpr double kRestS = 1.0;
  static constexpr double kStartS = 2.0;

  explicit HandHeldFlight(std::uint64_t seed);
  MotionState at(double t_s) const override;

 private:
  struct Sine {
    double amplitude, angular_frequency, phase;
  };
  struct Channel {
    double offset;
    std::array<Sine, 2> sines;
  };
  static Derivatives path_parameter(double t_s);
  static Derivatives evaluate(const Channel& channel, const Derivatives& s);

  std::array<Channel, 6> channels_;  // x, y, z [m], yaw, pitch, roll [rad]
};

// The motion behind recorded ground truth: a spline through its positions and one through its
// quaternions, brought to unit length. Both have two continuous derivatives, so that a camera can
// look along it and an ideal IMU can feel it. The velocities and biases of the recording are not
// used: in some recordings they are finite differences and zeros.
//
// Images are drawn along the interpolating spline, which meets every recorded pose. For a simulated
// IMU the recording must be smoothed first: positions written with 1e-6 m at 200 Hz have a rounding
// noise that double differentiation turns into 0.03 m/s², as much as the noise of the sensor.

class RecordedMotion : public Motion {
 public:
  /// Half of the amplitude of what oscillates at this frequency survives the smoothing. [Hz]
  static constexpr double kSmoothHz = 20;

  /// At least two poses. Time 0 of the motion is `origin_ns`.
  RecordedMotion(std::span<const GroundTruthPose> poses, std::int64_t origin_ns,
                 double half_gain_hz = SmoothingSpline::kInterpolate);

  /// Before and after the recording the body drifts on at the velocity of its ends.
  MotionState at(double t_s) const override;

 private:
  SmoothingSpline spline_;  // columns: position x y z, quaternion x y z w
};

// What an IMU reads along a motion: angular velocity and specific force (acceleration minus
// gravity) in the body frame, plus the errors of an ImuModel: white noise of density n becomes a
// standard deviation n √rate per sample, the bias walks by w / √rate per sample. Biases at turn-on
// are normal with the deviations below, the size of those in the ground truth of EuRoC's V1_02
// (up to 0.076 rad/s and 0.10 m/s²). Left out: quantisation, saturation, time jitter.

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
