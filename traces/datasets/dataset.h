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
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "traces/datasets/camera_model.h"
#include "traces/datasets/disturbance.h"

namespace leviosim::traces {

// A range of frames "A:B", B exclusive, as users write it on the command line.

struct FrameRange {
  std::size_t begin = 0;
  std::size_t end = 0;  ///< exclusive
};

/// Throws InputError unless `text` is A:B with 0 <= A < B.
FrameRange parse_frame_range(std::string_view text);

/// Throws InputError, which names `what`, unless the range selects from its `count` frames.
void check_frame_range(const FrameRange& range, std::size_t count, std::string_view what);

// The noise model of an inertial sensor as in EuRoC's sensor.yaml: white noise on each axis plus a
// bias that walks at random. Left out: scale factors, axis misalignment, saturation, temperature.

struct ImuModel {
  double rate_hz = 0;
  double gyro_noise_density = 0;   ///< [rad/s/√Hz]
  double gyro_random_walk = 0;     ///< [rad/s²/√Hz]
  double accel_noise_density = 0;  ///< [m/s²/√Hz]
  double accel_random_walk = 0;    ///< [m/s³/√Hz]
};

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
  Disturbance disturbance{};                  ///< that an ImageSource still makes to pictures
  std::vector<InputFiles> files = {};         ///< all that was read but the pictures
  std::string pictures = "cam0/data";         ///< what their folder is called
  std::filesystem::path imu_csv = {};         ///< for messages about samples
  std::filesystem::path truth_csv = {};       ///< and about ground truth
};

struct OpenOptions {
  std::optional<FrameRange> frames;  ///< all frames if absent
  /// The longest gap between IMU samples around the frames, in nominal IMU periods (plus 1 % for
  /// the jitter of recorded stamps).
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

// The IMU samples that belong to each frame: those after the previous frame, up to and including
// the frame itself (10 per frame for 200 Hz and 20 frames/s).

/// The samples with after_ns < t <= up_to_ns.
std::span<const ImuSample> imu_between(std::span<const ImuSample> samples, std::int64_t after_ns,
                                       std::int64_t up_to_ns);

/// The batch of frame i of `data`. Before frame 0 it reaches back by one nominal frame period, as
/// far as there are samples. A batch grows where the camera skipped a frame and may be empty at the
/// edges of the recording.
std::span<const ImuSample> imu_batch(const Dataset& data, std::size_t frame);

/// The sample at a time within the recording, interpolated linearly between its neighbours. Throws
/// InputError outside the recording.
ImuSample interpolate_imu(std::span<const ImuSample> samples, std::int64_t t_ns);

}  // namespace leviosim::traces
