// The keyframes of a window as the IMU alone carries the first one to them. Over a second or two
// its noise is nothing beside that of small images, and then the whole path follows from four
// vectors: the first keyframe's velocity, gravity, and the two biases. Position is linear in the
// first two.
//
// All in the first keyframe's camera frame. The IMU sits off the camera (Window::lever_arm):
// integrated is its path, stated the camera's.
#pragma once

#include "workload/graph/window.h"

namespace leviosim::vio {

/// What the path follows from.
template <class P>
struct CarriedFrom {
  Vec3<P> velocity;  ///< of the IMU at the first keyframe, m/s
  Vec3<P> gravity;   ///< of length kGravity, m/s²
  ImuBias<P> bias;
};

template <class P>
struct CarriedPose {
  using F = typename P::F32;

  Mat3<P> R;         ///< R_first_camera
  Vec3<P> p;         ///< of the camera, m
  Vec3<P> velocity;  ///< of the IMU, m/s
  F time;            ///< since the first keyframe, s
  // Derivatives; that of R in its right perturbation. Of p by velocity it is time, by gravity
  // time²/2.
  Mat3<P> R_by_gyro, p_by_gyro, p_by_accel;
};

/// One for each keyframe, in memory.
template <class P>
class CarriedPoses {
 public:
  using F = typename P::F32;
  using I32 = typename P::I32;
  using Span = typename P::template Span<F>;

  CarriedPoses(work::Arena& arena, int keyframes)
      : floats_(arena.alloc<Span>("carried poses", kFloats * keyframes)) {}

  CarriedPose<P> operator[](I32 k) const {
    const Span from = floats_.subspan(I32(k * I32(kFloats)), kFloats);
    return {load_mat3<P>(from, 0),         load_vec3<P>(from, kPosition),
            load_vec3<P>(from, kVelocity), F(from[kTime]),
            load_mat3<P>(from, kRByGyro),  load_mat3<P>(from, kPByGyro),
            load_mat3<P>(from, kPByAccel)};
  }
  void store(int k, const CarriedPose<P>& pose) const {
    const Span to = floats_.subspan(k * kFloats, kFloats);
    store_mat3<P>(to, 0, pose.R);
    store_vec3<P>(to, kPosition, pose.p);
    store_vec3<P>(to, kVelocity, pose.velocity);
    to[kTime] = pose.time;
    store_mat3<P>(to, kRByGyro, pose.R_by_gyro);
    store_mat3<P>(to, kPByGyro, pose.p_by_gyro);
    store_mat3<P>(to, kPByAccel, pose.p_by_accel);
  }

 private:
  enum Place : int {
    kPosition = 9,
    kVelocity = 12,
    kTime = 15,
    kRByGyro = 16,
    kPByGyro = 25,
    kPByAccel = 34,
    kFloats = 43,
  };

  Span floats_;
};

/// A keyframe as the IMU carries it on.
/// @param gravity    world frame, m/s²
/// @param lever_arm  the IMU in the camera frame, m
template <class P>
KeyframeState<P> carried_on(const KeyframeState<P>& from, const ImuDelta<P>& delta,
                            const Vec3<P>& gravity, const Vec3<P>& lever_arm) {
  using F = typename P::F32;
  const Pose<P>& T = from.T_world_camera;
  const Mat3<P> R = orthonormalised<P>(T.R * delta.R);
  const Vec3<P> fall = gravity * F(delta.dt * F(0.5f));
  return {
      {R, T.t + (from.velocity + fall) * delta.dt + T.R * (delta.p + lever_arm) - R * lever_arm},
      from.velocity + gravity * delta.dt + T.R * delta.v};
}

/// Fills `to` for all keyframes of the window.
template <class P>
void carry(const Window<P>& window, const CarriedFrom<P>& from, const CarriedPoses<P>& to);

}  // namespace leviosim::vio
