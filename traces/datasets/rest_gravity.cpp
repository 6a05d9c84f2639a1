#include "traces/datasets/rest_gravity.h"

#include <cmath>
#include <cstddef>
#include <limits>

namespace leviosim::traces {
namespace {

/// Of samples within a second at rest, beyond which a body shakes: propellers do so on the ground.
constexpr double kMostShaking = 0.5;  ///< standard deviation [m/s²]
constexpr double kMostTurning = 0.1;  ///< root mean square of the angular rate [rad/s]

/// Sums over a window that moves along the samples.
struct WindowSums {
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();
  double accel_squares = 0;
  double gyro_squares = 0;
  double count = 0;

  void add(const ImuSample& sample, double sign) {
    accel += sign * sample.accel;
    accel_squares += sign * sample.accel.squaredNorm();
    gyro_squares += sign * sample.gyro.squaredNorm();
    count += sign;
  }
  Eigen::Vector3d mean() const { return accel / count; }
  double shaking() const {
    return std::sqrt(std::max(0.0, accel_squares / count - mean().squaredNorm()));
  }
  double turning() const { return std::sqrt(std::max(0.0, gyro_squares / count)); }
};

}  // namespace

std::optional<double> gravity_at_rest(const Dataset& data) {
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  WindowSums sums;
  std::size_t first = 0;
  double least = std::numeric_limits<double>::infinity();
  std::optional<double> gravity;
  for (const ImuSample& sample : data.imu) {
    sums.add(sample, 1);
    if (sample.t_ns - data.imu[first].t_ns < kSecondNs) continue;
    if (sums.shaking() < kMostShaking && sums.turning() < kMostTurning && sums.shaking() < least) {
      least = sums.shaking();
      gravity = sums.mean().norm();
    }
    while (sample.t_ns - data.imu[first].t_ns >= kSecondNs) sums.add(data.imu[first++], -1);
  }
  return gravity;
}

}  // namespace leviosim::traces
