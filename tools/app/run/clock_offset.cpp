#include "tools/app/run/clock_offset.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace leviosim::tools {
namespace {

constexpr double kStep_s = 0.005;  ///< of what is tried
constexpr int kSteps = 20;         ///< in each direction
constexpr std::size_t kFewest = 40;
/// Rates that differ by more are wrong poses [rad/s].
constexpr double kOutlier = 0.3;
/// Less is within what stamps and exposures of cameras are off by [s].
constexpr double kMatters_s = 0.01;
constexpr double kCertain = 5;  ///< deviations

/// What the gyro has summed up to a time.
class GyroIntegral {
 public:
  explicit GyroIntegral(const std::vector<traces::ImuSample>& imu) : imu_(imu) {
    sums_.reserve(imu.size());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < imu.size(); ++i) {
      if (i > 0) sum += (imu[i].gyro + imu[i - 1].gyro) / 2 * seconds(imu[i - 1].t_ns, imu[i].t_ns);
      sums_.push_back(sum);
    }
  }

  static double seconds(std::int64_t from_ns, std::int64_t to_ns) {
    return 1e-9 * static_cast<double>(to_ns - from_ns);
  }

  bool covers(std::int64_t t_ns) const {
    return imu_.front().t_ns <= t_ns && t_ns <= imu_.back().t_ns;
  }

  Eigen::Vector3d at(std::int64_t t_ns) const {
    const auto next = std::lower_bound(
        imu_.begin() + 1, imu_.end() - 1, t_ns,
        [](const traces::ImuSample& sample, std::int64_t t) { return sample.t_ns < t; });
    const auto i = static_cast<std::size_t>(next - imu_.begin());
    const double share = seconds(imu_[i - 1].t_ns, t_ns) / seconds(imu_[i - 1].t_ns, imu_[i].t_ns);
    return sums_[i - 1] + share * (sums_[i] - sums_[i - 1]);
  }

 private:
  const std::vector<traces::ImuSample>& imu_;
  std::vector<Eigen::Vector3d> sums_;
};

/// Between two poses in a row that were located.
struct Turn {
  std::int64_t from_ns, to_ns;
  Eigen::Vector3d rate;  ///< of the body, there [rad/s]
};

std::vector<Turn> turns_of(const std::vector<FrameResult>& frames) {
  std::vector<Turn> turns;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const FrameResult &last = frames[i - 1], &now = frames[i];
    if (last.source != PoseSource::Tracked || now.source != PoseSource::Tracked) continue;
    const Eigen::AngleAxisd turn(Eigen::Quaterniond(last.pose.T_world_body.linear().transpose() *
                                                    now.pose.T_world_body.linear()));
    const double dt = GyroIntegral::seconds(last.t_ns, now.t_ns);
    if (dt > 0) turns.push_back({last.t_ns, now.t_ns, turn.axis() * (turn.angle() / dt)});
  }
  return turns;
}

/// Over the turns for which all that is tried has samples.
class Comparison {
 public:
  Comparison(const GyroIntegral& gyro, std::vector<Turn> turns)
      : gyro_(gyro), turns_(std::move(turns)) {
    const std::int64_t most = shift_ns(kSteps + 1);
    std::erase_if(turns_, [&](const Turn& turn) {
      return !gyro.covers(turn.from_ns - most) || !gyro.covers(turn.to_ns + most);
    });
  }

  std::size_t size() const { return turns_.size(); }

  /// Mean square of the rates' differences but for a constant one.
  double mean_square(int step) const {
    std::vector<Eigen::Vector3d> differences;
    for (const Turn& turn : turns_) differences.push_back(turn.rate - rate(turn, step));
    const Eigen::Vector3d bias = median(differences);
    double sum = 0;
    for (const Eigen::Vector3d& d : differences)
      sum += std::min((d - bias).squaredNorm(), kOutlier * kOutlier);
    return sum / static_cast<double>(size());
  }

  /// Sum of the squares of the rate's change with the offset [rad²/s⁴].
  double information(int step) const {
    double sum = 0;
    for (const Turn& turn : turns_)
      sum += ((rate(turn, step + 1) - rate(turn, step - 1)) / (2 * kStep_s)).squaredNorm();
    return sum;
  }

 private:
  static std::int64_t shift_ns(int step) { return std::llround(1e9 * kStep_s * step); }

  Eigen::Vector3d rate(const Turn& turn, int step) const {
    const std::int64_t shift = shift_ns(step);
    return (gyro_.at(turn.to_ns + shift) - gyro_.at(turn.from_ns + shift)) /
           GyroIntegral::seconds(turn.from_ns, turn.to_ns);
  }

  static Eigen::Vector3d median(const std::vector<Eigen::Vector3d>& of) {
    Eigen::Vector3d middle;
    std::vector<double> values(of.size());
    for (int axis = 0; axis < 3; ++axis) {
      std::transform(of.begin(), of.end(), values.begin(),
                     [&](const Eigen::Vector3d& v) { return v[axis]; });
      const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
      std::nth_element(values.begin(), half, values.end());
      middle[axis] = *half;
    }
    return middle;
  }

  const GyroIntegral& gyro_;
  std::vector<Turn> turns_;
};

}  // namespace

bool ClockOffset::is_certain() const {
  return std::abs(seconds) >= kMatters_s && std::abs(seconds) > kCertain * deviation;
}

std::string ClockOffset::text() const {
  return fmt::format(
      "images {} the IMU by about {:.0f} ms: `timeshift_cam_imu: {:+.3f}`, added to what "
      "cam0/sensor.yaml has, puts them right",
      seconds < 0 ? "follow" : "precede", 1e3 * std::abs(seconds), seconds);
}

std::optional<ClockOffset> find_clock_offset(const std::vector<traces::ImuSample>& imu,
                                             const std::vector<FrameResult>& frames) {
  if (imu.size() < 2) return std::nullopt;
  const GyroIntegral gyro(imu);
  const Comparison comparison(gyro, turns_of(frames));
  if (comparison.size() < kFewest) return std::nullopt;
  std::array<double, 2 * kSteps + 1> costs{};
  for (int step = -kSteps; step <= kSteps; ++step)
    costs[static_cast<std::size_t>(step + kSteps)] = comparison.mean_square(step);
  const auto best = std::min_element(costs.begin(), costs.end());
  if (best == costs.begin() || best == costs.end() - 1) return std::nullopt;
  const int step = static_cast<int>(best - costs.begin()) - kSteps;
  const double bend = best[-1] - 2 * best[0] + best[1];
  const double part = bend > 0 ? (best[-1] - best[1]) / (2 * bend) : 0;  // of a parabola
  const double information = comparison.information(step);
  if (!(information > 0)) return std::nullopt;
  const double variance = *best / 3;  // of each axis
  return ClockOffset{kStep_s * (step + part), std::sqrt(variance / information)};
}

}  // namespace leviosim::tools
