// How the camera moved over the last frame, for the prediction of the next one. Relative to the
// newest keyframe, so that it stays true when the optimiser moves the map. In L2.
#pragma once

#include "workload/inertial/record.h"
#include "workload/vio/frame.h"

namespace leviosim::vio {

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

}  // namespace leviosim::vio
