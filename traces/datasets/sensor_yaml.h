// Reading of the two sensor.yaml files of an ASL folder. Strict where it matters: a missing key, a
// list of the wrong length or an unsupported model is an InputError that names file, line and key;
// keys that are not needed (comments, extra entries) are passed over.
#pragma once

#include <filesystem>

#include "traces/datasets/camera_model.h"
#include "traces/datasets/imu_model.h"

namespace leviosim::traces {

/// The largest picture that is read: 4096x4096, which is beyond the cameras that odometry uses, and
/// of which a picture and the tables that undistort it take 120 MB.
constexpr int kMostPixels = 1 << 24;

/// Reads cam0/sensor.yaml. Supported: camera_model pinhole, distortion_model radial-tangential and
/// equidistant. The optional key `prepared: true` is ours: CameraModel::prepared.
CameraModel read_camera_model(const std::filesystem::path& sensor_yaml);

/// Reads imu0/sensor.yaml. Its T_BS must be the identity: the body frame is the IMU frame.
ImuModel read_imu_model(const std::filesystem::path& sensor_yaml);

}  // namespace leviosim::traces
