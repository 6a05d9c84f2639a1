// Where the camera must be by now: moved on from the last keyframe as the IMU measured, or from the
// last frame at its velocity.
#pragma once

#include "workload/inertial/record.h"
#include "workload/vio/frame.h"
#include "workload/vio/inertial_part.h"
#include "workload/vio/records.h"

namespace leviosim::vio {

// How the camera moved over the last frame, for the prediction of the next one. Relative to the
// newest keyframe, so that it stays true when the optimiser moves the map. In L2.

template <class P>
class MotionRecord {
 public:
  using F = typename P::F32;
  using Span = typename P::template L2Span<F>;

  static constexpr int kFloats = kPoseFloats + 3 + 9 + kPoseFloats;

  MotionRecord() = default;
  explicit MotionRecord(work::Arena& arena)
      : floats_(
            arena.alloc<typename P::template Span<F>>("motion of the last frame", kFloats).data(),
            kFloats) {}

  /// Pose of the last frame.
  Pose<P> T_keyframe_camera() const { return load_pose<P>(floats_, 0); }
  /// In the last frame's camera frame, m/s.
  Vec3<P> velocity() const { return load_vec3<P>(floats_, kVelocity); }
  /// Rotation of the last frame as the gyro has it.
  Mat3<P> gyro_rotation() const { return load_mat3<P>(floats_, kGyro); }

  /// Pose of the last frame as it was reported, which the optimiser does not move.
  Pose<P> T_world_camera() const { return load_pose<P>(floats_, kReported); }

  void store(const Pose<P>& T_keyframe_camera, const Vec3<P>& velocity,
             const Mat3<P>& gyro_rotation, const Pose<P>& T_world_camera) const {
    store_pose<P>(floats_, 0, T_keyframe_camera);
    store_vec3<P>(floats_, kVelocity, velocity);
    store_mat3<P>(floats_, kGyro, gyro_rotation);
    store_pose<P>(floats_, kReported, T_world_camera);
  }

 private:
  enum Place : int { kVelocity = kPoseFloats, kGyro = kPoseFloats + 3, kReported = kGyro + 9 };

  Span floats_;
};

/// A frame and the one before it.
template <class P>
struct TrackedFrame : Frame<P> {
  float dt = 0;            ///< since the frame before [s]
  Pose<P> T_world_last{};  ///< pose of the frame before, in the map as it is now
};

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

  /// Leaves the motion over this frame for the next one.
  void remember(const TrackedFrame<P>& frame, const FrameReport& report);

 private:
  const FrontEndState<P>& state_;
  const InertialPart<P>& inertial_;
  const MapStatus& map_;
  MotionRecord<P> motion_;
  bool lost_ = false;  ///< the last pose was predicted
};

// What cannot be true: maps, poses and rotations beyond what a vehicle does.

/// Whether the map has a meaning.
/// @param stays  poses do not change by metres any more, as they may before a map is aligned
template <class P>
bool map_is_plausible(const FrontEndState<P>& state, const Prediction<P>& prediction, bool stays);

/// Whether T_world_camera is a pose to which the camera can have got from where it was reported
/// last.
/// @param seconds  that this took at most
template <class P>
bool pose_is_plausible(const FrontEndState<P>& state, const Prediction<P>& prediction,
                       const Pose<P>& T_world_camera, float seconds);

/// Whether the gyro saw this rotation since the keyframe, but for the largest bias.
/// The 8-point algorithm's choice among its four solutions is wrong at times, and a map that begins
/// with one is of no use.
template <class P>
bool agrees_with_gyro(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                      const Mat3<P>& R_camera_keyframe);

}  // namespace leviosim::vio
