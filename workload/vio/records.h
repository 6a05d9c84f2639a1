// What goes into the odometry and what comes out of it, frame by frame. Plain numbers, without an
// arithmetic policy: callers build and read these records.
#pragma once

#include <array>
#include <cstdint>
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

struct FrameReport : FrameFacts, CameraPose {
  std::vector<EarlierPose> earlier;
};

// What front end and back end tell each other about the map beside the pose graph.

/// How well what was found explains a window: mean squares of whitened residuals, of which noise as
/// it is assumed leaves 1 or less.
struct WindowFit {
  float visual = 0;
  float inertial = 0;
  float prior = 0;  ///< of the past; less than nothing where the prior's minimum lies elsewhere
  /// Standard deviation of the scale of the positions, as a share of it: the alignment's, then that
  /// of the last full window that was hardly damped.
  float scale_sigma = 0;
  bool solved = true;    ///< the last iteration's system could be factored
  float accel_bias = 0;  ///< in standard deviations of what is known of it beforehand
};

struct MapStatus {
  /// Velocity, gravity and scale are known: from rest, or from the initialisation. Until then a map
  /// that has an initialisation has landmarks without a distance.
  bool aligned = false;
  /// The initialisation has once converged, from more than few keyframes, to what can be true,
  /// though it may be uncertain.
  bool converged = false;
  /// Of what is seen, 1/m, as the alignment has it; 0 before there is one.
  float inverse_depth = 0;
  WindowFit fit;  ///< of the last window since the alignment
};

}  // namespace leviosim::vio
