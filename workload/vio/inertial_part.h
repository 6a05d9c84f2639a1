// The IMU in a front end: motion since the last keyframe, gravity and gyro bias at rest, and the
// predicted pose.
#pragma once

#include <optional>

#include "workload/inertial/initialisation.h"
#include "workload/vio/front_end_state.h"

namespace leviosim::vio {

template <class P>
class InertialPart {
 public:
  using F = typename P::F32;
  using Floats = typename P::template Span<F>;

  /// @param state  outlives this
  explicit InertialPart(const FrontEndState<P>& state);

  /// Adds the samples since the last frame to the motion since the last keyframe. Before the first
  /// frame there is no motion to measure: the forces are summed up for gravity, in the place of the
  /// motion.
  void integrate(const FrameInput& input);

  /// Since the last keyframe, at the bias of the graph.
  ImuDelta<P> motion_since_keyframe() const;

  /// A keyframe's pose, moved on by the motion since then.
  Pose<P> moved_on(const KeyframeState<P>& from, const ImuDelta<P>& delta) const;
  /// The keyframe state from which a motion leads to `to`.
  KeyframeState<P> moved_back(const KeyframeState<P>& to, const ImuDelta<P>& delta) const;
  /// The last keyframe's pose, moved on as the IMU measured; without an IMU, at its velocity.
  Pose<P> predicted_pose() const;

  /// Means over the last second if the vehicle stands still; only for the joint optimiser.
  const std::optional<Stillness<P>>& rest() const { return rest_; }
  /// The images show that the vehicle moves: there is no rest until the IMU has seen motion, too.
  void reject_rest() {
    rest_.reset();
    rest_is_rejected_ = true;
  }
  bool rest_is_rejected() const { return rest_is_rejected_; }
  /// The same means, whether it stands still or not.
  const Stillness<P>& recent() const { return recent_; }
  /// Whether these can be a bias and gravity.
  bool recent_may_be_rest() const { return may_be_rest(recent_); }

 private:
  ImuNoise noise_of(const ImuInput& sample) const;
  bool may_be_rest(const Stillness<P>& seen) const;
  void detect_stillness(const Preintegration<P>& interval, float seconds);
  Vec3<P> lever_arm() const;  // from the camera to the IMU

  const FrontEndState<P>& state_;
  Mat3<P> R_camera_body_;
  StillnessDetector<P> stillness_;
  std::optional<Stillness<P>> rest_;
  bool rest_is_rejected_ = false;
  Stillness<P> recent_{false, {0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}, 0.0f};
};

}  // namespace leviosim::vio
