#include "workload/vio/odometry/map_health.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "sim/work/functions.h"

namespace leviosim::vio {
namespace {

/// Not true of what is no number.
bool fits(const WindowFit& fit, float limit) {
  return fit.visual < limit && fit.inertial < limit && fit.prior < limit;
}

bool is_blind(const FrameReport& report) {
  return report.source == PoseSource::Predicted || report.source == PoseSource::Kept;
}

}  // namespace

void MapHealth::take_window() { inconsistent_ = !fits(map_.fit, profile_.health.mean_square); }

/// Whether the map waits for its alignment.
bool MapHealth::waits() const {
  return profile_.alignment.enabled && profile_.optimiser.joint && !map_.aligned;
}

/// What images see has another scale or another direction of gravity than what the IMU feels. The
/// images may contradict each other alone, where something else moves.
bool MapHealth::contradicts_imu() const {
  const HealthOptions& limits = profile_.health;
  return !(map_.fit.inertial < limits.mean_square && map_.fit.prior < limits.mean_square &&
           map_.fit.accel_bias < limits.accel_bias);
}

Health MapHealth::after_frame(const FrameReport& report, float dt) {
  if (!profile_.optimiser.joint) return Health::not_judged;  // the limits are of its windows
  const HealthOptions& limits = profile_.health;
  doubted_s_ = inconsistent_ ? limits.memory_s : doubted_s_ - dt;
  track(report, dt);
  add_drift(report, dt);
  restarted_ = waits() && (restarted_ || (report.map_restarts > 0 && was_aligned_));
  was_aligned_ = !waits();
  if (restarted_ || blind_s_ > profile_.recovery.max_blind_time ||
      !(map_.fit.accel_bias < limits.lost_accel_bias))
    return Health::lost;
  const bool good = !waits() && doubted_s_ <= 0 && tracked_ > limits.tracked &&
                    map_.fit.accel_bias < limits.accel_bias && drift_m_ <= limits.drift * path_m_;
  return good ? Health::good : Health::unreliable;
}

/// A frame without a pose from landmarks has none that agree, unless it needs none.
void MapHealth::track(const FrameReport& report, float dt) {
  const bool blind = is_blind(report);
  const bool by_landmarks =
      report.source == PoseSource::Tracked || report.source == PoseSource::Epnp;
  if (!blind && !by_landmarks) return;
  const float share =
      blind || report.world_matches == 0
          ? 0.0f
          : static_cast<float>(report.inliers) / static_cast<float>(report.world_matches);
  tracked_ += (share - tracked_) * std::min(1.0f, dt / profile_.health.memory_s);
}

void MapHealth::add_drift(const FrameReport& report, float dt) {
  const HealthOptions& limits = profile_.health;
  const std::array<float, 3>& now = report.p_world_camera;
  const std::array<float, 3> last = std::exchange(last_, now).value_or(now);
  float square = 0;
  for (std::size_t a = 0; a < now.size(); ++a) square += (now[a] - last[a]) * (now[a] - last[a]);
  const float moved = work::sqrt(square);
  const bool blind = is_blind(report);
  // What images put right when they come back was wrong before, and no motion.
  (!blind && blind_s_ > 0 ? drift_m_ : path_m_) += moved;
  blind_s_ = blind ? blind_s_ + dt : 0;
  if (blind) drift_m_ += (limits.blind_velocity + limits.blind_acceleration * blind_s_) * dt;
  unaligned_m_ += moved;
  if (!waits()) {
    const float uncertain = contradicts_imu() ? 1 : map_.fit.uncertainty;
    if (!was_aligned_ || !(uncertain <= limits.drift)) drift_m_ += uncertain * unaligned_m_;
    unaligned_m_ = 0;
  }
  if (report.map_restarts > 0 && was_aligned_) drift_m_ += profile_.recovery.max_correction;
}

}  // namespace leviosim::vio
