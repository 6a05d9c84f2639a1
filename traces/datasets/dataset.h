// What a recorded or synthetic flight consists of: one camera, one IMU, perhaps ground truth.
// Frames: the world is fixed to the ground, z up; the body frame is the IMU frame; the camera frame
// has x right, y down, z forward. Time stamps are nanoseconds and rise strictly within each list.
// Images stay on disk until an ImageSource reads them. A recording without a gyroscope has no IMU
// samples; its body frame is the camera frame then.
#pragma once

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "traces/datasets/camera_model.h"
#include "traces/datasets/disturbance.h"
#include "traces/datasets/faulty_pixels.h"
#include "traces/datasets/frame_range.h"
#include "traces/datasets/imu_model.h"

namespace leviosim::traces {

struct FrameRef {
  std::int64_t t_ns = 0;
  std::filesystem::path path;
  std::size_t line = 0;  ///< of the list of frames
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

/// Text files that were read, one or many of a kind.
struct InputFiles {
  std::string name;  ///< "imu0/data.csv"
  std::vector<std::filesystem::path> files;
};

struct Dataset {
  std::filesystem::path frames_csv;  ///< the list of frames, for messages about them
  CameraModel camera;
  ImuModel imu_model;
  std::vector<FrameRef> frames;               ///< never empty
  std::vector<ImuSample> imu;                 ///< covers the frames; empty without a gyroscope
  std::vector<GroundTruthPose> ground_truth;  ///< empty if the folder has none
  PixelMask faulty_pixels = {};               ///< of the camera, which an ImageSource mends
  Disturbance disturbance{};                  ///< that an ImageSource still makes to pictures
  std::vector<InputFiles> files = {};         ///< all that was read but the pictures
  std::string pictures = "cam0/data";         ///< what their folder is called
  std::filesystem::path imu_csv = {};         ///< for messages about samples
  std::filesystem::path truth_csv = {};       ///< and about ground truth
  std::size_t first_frame = 0;                ///< number of the first of the frames, of all
  std::vector<std::string> notes = {};        ///< what was mended, a sentence each
};

struct OpenOptions {
  std::optional<FrameRange> frames;  ///< all frames if absent
  /// The longest gap between IMU samples around the frames that is left as it is, in nominal IMU
  /// periods (plus 1 % for the jitter of recorded stamps).
  double max_imu_gap_periods = 3;
  /// How far a frame may lie outside the IMU samples, in nominal IMU periods.
  double imu_edge_periods = 1;
  Disturbance disturbance{};  ///< made after everything has been checked
};

/// From the median period of stamps, of which there are at least two. [Hz]
double rate_of(const std::vector<std::int64_t>& stamps_ns, const std::filesystem::path& file);
std::vector<std::int64_t> stamps_of(const std::vector<FrameRef>& frames);

/// What was read, with the frames that were asked for and the disturbance made. Throws InputError
/// if images are missing or the IMU, where there is one, does not cover the frames.
Dataset opened(Dataset data, const OpenOptions& options);

}  // namespace leviosim::traces
