// What a recorded or synthetic flight consists of: one camera, one IMU, perhaps ground truth.
// Frames: the world is fixed to the ground, z up; the body frame is the IMU frame; the camera frame
// has x right, y down, z forward. Time stamps are nanoseconds and rise strictly within each list.
// Images stay on disk until an ImageSource reads them.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "traces/datasets/camera_model.h"
#include "traces/datasets/disturbance.h"
#include "traces/datasets/imu_model.h"

namespace leviosim::traces {

struct FrameRef {
  std::int64_t t_ns = 0;
  std::filesystem::path path;
  std::size_t line = 0;  ///< of cam0/data.csv
};

/// Angular velocity [rad/s] and specific force [m/s²] in the body frame, as measured.
struct ImuSample {
  std::int64_t t_ns = 0;
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();
};

struct GroundTruthPose {
  std::int64_t t_ns = 0;
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();  ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();              ///< in the world [m/s]
  Eigen::Vector3d bias_gyro = Eigen::Vector3d::Zero();             ///< [rad/s]
  Eigen::Vector3d bias_accel = Eigen::Vector3d::Zero();            ///< [m/s²]
};

struct Dataset {
  std::filesystem::path frames_csv;  ///< cam0/data.csv, for messages about frames
  CameraModel camera;
  ImuModel imu_model;
  std::vector<FrameRef> frames;               ///< never empty
  std::vector<ImuSample> imu;                 ///< covers the frames
  std::vector<GroundTruthPose> ground_truth;  ///< empty if the folder has none
  Disturbance disturbance{};                  ///< that an ImageSource still makes to pictures
};

}  // namespace leviosim::traces
