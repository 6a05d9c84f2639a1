// The predicted pose of the camera: from the last keyframe by the IMU's motion, or from the last
// frame at constant velocity.
#pragma once

#include "workload/next/motion_record.h"
#include "workload/vio/inertial_part.h"
#include "workload/vio/map_status.h"
#include "workload/vio/records.h"

namespace leviosim::vio {

template <class P>
class Prediction {
 public:
  /// @param state, inertial, map  outlive this
  Prediction(const FrontEndState<P>& state, const InertialPart<P>& inertial, const MapStatus& map,
             work::Arena& keyframe_memory)
      : state_(state), inertial_(inertial), map_(map), motion_(keyframe_memory) {}

  /// Where the last frame was, in the map as it is now.
  Pose<P> last_pose() const;
  /// The last frame's pose as it was reported, which the optimiser does not move.
  Pose<P> last_reported() const { return motion_.T_world_camera(); }

  /// Whether the newest keyframe's velocity is known, from the begin of the map or from a window
  /// full of keyframes, and recent enough to carry the prediction.
  bool imu_predicts() const;
  bool window_is_full() const;
  /// The last frame's pose, turned as the gyro says and moved on at its velocity.
  Pose<P> by_motion(const TrackedFrame<P>& frame) const;
  /// T_world_camera, by the IMU or by motion.
  Pose<P> of(const TrackedFrame<P>& frame) const {
    return imu_predicts() ? inertial_.predicted_pose() : by_motion(frame);
  }

  /// The map has been aligned, which moves it by metres: what was reported before is no measure of
  /// where the camera can be now. The last frame counts as reported where the map has it.
  void follow_alignment();
  /// Leaves the motion over this frame for the next one.
  void remember(const TrackedFrame<P>& frame, const FrameReport& report);

 private:
  const FrontEndState<P>& state_;
  const InertialPart<P>& inertial_;
  const MapStatus& map_;
  MotionRecord<P> motion_;
  bool lost_ = false;  ///< the last pose was predicted
};

}  // namespace leviosim::vio
