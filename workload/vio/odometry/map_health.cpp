#include "workload/vio/odometry/map_health.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
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

float distance(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  float square = 0;
  for (std::size_t i = 0; i < a.size(); ++i) square += (a[i] - b[i]) * (a[i] - b[i]);
  return work::sqrt(square);
}

/// Length of the path through `poses`, m.
float length_of(std::span<const EarlierPose> poses) {
  float length = 0;
  for (std::size_t i = 1; i < poses.size(); ++i)
    length += distance(poses[i - 1].p_world_camera, poses[i].p_world_camera);
  return length;
}

}  // namespace

void MapHealth::take_window() { inconsistent_ = !fits(map_.fit, profile_.health.mean_square); }

/// Whether the map waits for its alignment.
bool MapHealth::waits() const { return profile_.initialises() && !map_.aligned; }

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
  follow_corrections(report.earlier, dt);
  add_drift(report, dt);
  restarted_ = waits() && (restarted_ || (report.map_restarts > 0 && was_aligned_));
  was_aligned_ = !waits();
  using Reason = HealthReason;
  reasons_ = 0;
  for (const auto& [reason, holds] :
       {std::pair{Reason::NoScale, waits()},
        {Reason::Inconsistent, !(doubted_s_ <= 0)},
        {Reason::Blind, !(blind_s_ <= limits.blind_s)},
        {Reason::FewInliers, !(tracked_ > limits.tracked)},
        {Reason::AccelBias, !(map_.fit.accel_bias < limits.accel_bias)},
        {Reason::Drift, drifts()},
        {Reason::Restarted, restarted_}})
    if (holds) reasons_ |= bit(reason);
  if (restarted_ || blind_s_ > profile_.recovery.max_blind_time ||
      !(map_.fit.accel_bias < limits.lost_accel_bias))
    return Health::lost;
  return reasons_ == 0 ? Health::good : Health::unreliable;
}

/// Frames without a pose from landmarks say nothing; what the IMU alone gets wrong is drift.
void MapHealth::track(const FrameReport& report, float dt) {
  const bool by_landmarks =
      report.source == PoseSource::Tracked || report.source == PoseSource::Epnp;
  if (!by_landmarks || report.world_matches == 0) return;
  const float share = static_cast<float>(report.inliers) / static_cast<float>(report.world_matches);
  tracked_ += (share - tracked_) * std::min(1.0f, dt / profile_.health.memory_s);
}

/// Compares the length of the earlier poses with what it was in the last frame, when all but the
/// newest of them were there. Noise of windows lengthens and shortens it in turn.
void MapHealth::follow_corrections(const std::vector<EarlierPose>& earlier, float dt) {
  corrections_ *= std::max(0.0f, 1 - dt / profile_.health.memory_s);
  const std::vector<EarlierPose> last = std::exchange(earlier_, earlier);
  if (!was_aligned_ || earlier.empty()) return;
  const std::size_t both = std::min(last.size(), earlier.size() - 1);
  const float before = length_of(std::span(last).first(both));
  const float change = length_of(std::span(earlier).subspan(1, both)) - before;
  if (before > 0) corrections_ += change / before;
  if (both == 0 || both == last.size()) return;
  const float left = length_of(std::span(last).subspan(both - 1));  // nothing corrects it any more
  path_m_ += left;
  drift_m_ += scale_sigma() * left;
}

/// Adds what the path has grown by, and how far its end may be off.
void MapHealth::add_drift(const FrameReport& report, float dt) {
  const HealthOptions& limits = profile_.health;
  const std::array<float, 3>& now = report.p_world_camera;
  const float moved = distance(now, std::exchange(last_, now).value_or(now));
  const bool blind = is_blind(report);
  // What images put right when they come back was wrong before, and no motion.
  if (!blind && blind_s_ > 0)
    drift_m_ += moved;
  else
    open_m_ += moved;
  blind_s_ = blind ? blind_s_ + dt : 0;
  if (!blind) velocity_error_ = report.at_rest > 0 ? 0 : limits.blind_velocity;
  if (blind) drift_m_ += (velocity_error_ + limits.blind_acceleration * blind_s_) * dt;
  if (report.source == PoseSource::First) {  // a map begins: no window says more of what was before
    if (was_aligned_ || path_m_ > 0)
      settle(sigma_);
    else
      drift_m_ = open_m_ = 0;  // of guesses
  } else if (!report.earlier.empty()) {
    open_m_ = length_of(report.earlier) + distance(report.earlier.front().p_world_camera, now);
  } else if (!waits()) {
    settle(scale_sigma());
  }
  sigma_ = scale_sigma();
  if (report.map_restarts > 0 && was_aligned_) drift_m_ += profile_.recovery.max_correction;
}

/// Nothing corrects the open path any more.
void MapHealth::settle(float sigma) {
  drift_m_ += sigma * open_m_;
  path_m_ += std::exchange(open_m_, 0.0f);
}

float MapHealth::path() const { return path_m_ + (waits() ? 0 : open_m_); }

float MapHealth::path_deviation() const {
  return drift_m_ + (waits() ? 0 : scale_sigma() * open_m_);
}

/// Whether how far the path's end may be off matters: beside the path, and beside the noise that
/// any two poses differ by.
bool MapHealth::drifts() const {
  return !(path_deviation() <= std::max(profile_.health.drift * path(), profile_.rest.position));
}

float MapHealth::scale_sigma() const {
  if (!map_.fit.solved || contradicts_imu()) return 1;
  return work::sqrt(map_.fit.scale_sigma * map_.fit.scale_sigma + corrections_ * corrections_);
}

}  // namespace leviosim::vio
