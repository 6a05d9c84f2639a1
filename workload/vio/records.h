// What goes into the odometry and what comes out of it, frame by frame. Plain numbers, without an
// arithmetic policy: callers build and read these records.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "workload/math/pinhole_camera.h"
#include "workload/vio/frame_facts.h"

namespace leviosim::vio {

/// One IMU sample in the body (IMU) frame.
struct ImuInput {
  float dt;        ///< since the sample before [s]
  float gyro[3];   ///< [rad/s]
  float accel[3];  ///< specific force [m/s²]
};

struct FrameInput {
  const std::uint8_t* pixels;  ///< width × height, row by row, undistorted
  int width;
  int height;
  float dt;  ///< since the frame before [s]; 0 for the first
  std::vector<ImuInput> imu;
  bool wants_features = false;  ///< the report shall hold them
};

/// Camera and its place on the body.
struct Rig {
  PinholeCamera camera;  ///< of the undistorted, decimated image [px]
  int width;
  int height;
  std::array<float, 9> R_camera_body;    ///< row-major
  std::array<float, 3> p_camera_body{};  ///< of the body (IMU) in the camera frame [m]
  float frame_rate = 20;                 ///< [1/s]
};

struct CameraPose {
  std::array<float, 9> R_world_camera{};  ///< row-major
  std::array<float, 3> p_world_camera{};  ///< [m]
};

/// Where an earlier frame was after all.
struct EarlierPose : CameraPose {
  int frames_ago = 0;  ///< frames processed since then
};

/// What became of a feature.
enum class FeatureState : std::uint8_t {
  Detected,  ///< nothing was found like it
  Matched,   ///< with a feature of the last keyframe
  Agrees,    ///< shows a landmark where the pose puts it
  Rejected,  ///< looks like a landmark that is elsewhere
  New        ///< of which a landmark was made with this frame
};

struct SeenFeature {
  FeatureState state = FeatureState::Detected;
  float x = 0, y = 0;                ///< [px]
  float x_before = 0, y_before = 0;  ///< in the last keyframe, or as x and y without a match [px]
  std::array<float, 3> p_world{};    ///< of the landmark that it agrees with, or that is new [m]
};

struct FrameReport : FrameFacts, CameraPose {
  std::vector<EarlierPose> earlier;
  std::optional<std::vector<SeenFeature>> seen;  ///< where FrameInput::wants_features
};

}  // namespace leviosim::vio
