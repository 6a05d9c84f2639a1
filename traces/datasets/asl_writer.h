// The text files of an ASL folder. What is formatted here, asl_reader.h reads back. Numbers of
// sensor.yaml are printed so that they read back exactly, those of data.csv with ten decimals.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "traces/datasets/camera_model.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/imu_model.h"

namespace leviosim::traces {

std::string format_camera_yaml(const CameraModel& camera, const std::string& comment);
std::string format_imu_yaml(const ImuModel& imu, const std::string& comment);
std::string format_ground_truth_yaml(const std::string& comment);

/// The name of the image of a time stamp, "<ns>.png".
std::string image_name(std::int64_t t_ns);

std::string format_frames_csv(const std::vector<std::int64_t>& stamps_ns);
std::string format_imu_csv(const std::vector<ImuSample>& samples);
/// The 17 columns of EuRoC. Quaternions have w >= 0.
std::string format_ground_truth_csv(const std::vector<GroundTruthPose>& poses);

}  // namespace leviosim::traces
