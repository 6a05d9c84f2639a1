// Reading of the two sensor.yaml files of an ASL folder, and of the same facts in the files of the
// calibration program Kalibr. Strict where it matters: a missing key, a
// list of the wrong length or an unsupported model is an InputError that names file, line and key;
// keys that are not needed (comments, extra entries) are passed over.
#pragma once

#include <filesystem>

#include "traces/datasets/camera_model.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/imu_model.h"

namespace leviosim::traces {

/// The largest picture that is read: 4096x4096, which is beyond the cameras that odometry uses, and
/// of which a picture and the tables that undistort it take 120 MB.
constexpr int kMostPixels = 1 << 24;

/// Reads cam0/sensor.yaml. Supported: camera_model pinhole, distortion_model radial-tangential and
/// equidistant. Optional: `timeshift_cam_imu`, as Kalibr has it, and `prepared: true`, which is
/// ours: CameraModel::prepared.
CameraModel read_camera_model(const std::filesystem::path& sensor_yaml);

/// Takes the mask that cam0/sensor.yaml names as `faulty_pixels`, which is ours: a picture beside
/// it in which all but black marks pixels that show nothing.
void take_faulty_pixels(const std::filesystem::path& sensor_yaml, Dataset& data);

/// Holds the rates that cam0/sensor.yaml and imu0/sensor.yaml in the folder state against the
/// median periods of frames and samples, where there are three.
void expect_rates(const std::filesystem::path& folder, const Dataset& data);

/// Reads imu0/sensor.yaml. Its T_BS must be the identity: the body frame is the IMU frame.
/// Optional: `accelerometer_scale`, which is ours: ImuModel::accel_scale.
ImuModel read_imu_model(const std::filesystem::path& sensor_yaml);

/// The camera cam0 of a chain as Kalibr writes it, without its rate, which the file does not hold.
CameraModel read_kalibr_camera(const std::filesystem::path& camchain_yaml);
/// Kalibr's description of an IMU.
ImuModel read_kalibr_imu(const std::filesystem::path& imu_yaml);

/// Puts the stamps of frames on the IMU's clock and accelerations to scale, as both models say.
void apply_calibration(Dataset& data);

}  // namespace leviosim::traces
