#include <fmt/core.h>

#include <cmath>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/imu_samples.h"
#include "traces/datasets/row_values.h"
#include "traces/datasets/sensor_yaml.h"
#include "traces/recordings/formats.h"
#include "traces/trajectories/trajectory.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCameras = "dso/camchain.yaml";
constexpr const char* kImu = "dso/imu_config.yaml";

}  // namespace

bool is_tum_vi(const fs::path& folder) {
  return base::is_folder(folder / "mav0") && base::is_file(folder / kCameras) &&
         !base::exists(folder / "mav0/cam0/sensor.yaml");
}

Dataset read_tum_vi(const fs::path& folder) {
  if (!base::is_file(folder / kImu))
    throw InputError(fmt::format("{} not found in {}; TUM-VI has it beside {}", kImu,
                                 folder.string(), kCameras));
  Dataset data;
  data.camera = read_kalibr_camera(folder / kCameras);
  data.imu_model = read_kalibr_imu(folder / kImu);
  read_asl_streams(folder / "mav0", data);
  data.camera.rate_hz = rate_of(stamps_of(data.frames), data.frames_csv);
  apply_calibration(data);
  for (const char* name : {kCameras, kImu}) data.files.push_back({name, {folder / name}});
  return data;
}

namespace {

constexpr const char* kFrames = "rgb.txt";
constexpr const char* kGyro = "gyroscope.txt";
constexpr const char* kAccel = "accelerometer.txt";
constexpr const char* kTruth = "groundtruth.txt";

fs::path required(const fs::path& folder, const char* name, const char* why) {
  if (!base::is_file(folder / name))
    throw InputError(fmt::format("{} not found in {}; {}", name, folder.string(), why));
  return folder / name;
}

std::vector<FrameRef> read_frames(const fs::path& file) {
  base::CsvReader csv(file, base::Separator::blanks, {"timestamp [s]", "filename"});
  base::RisingStamps stamps;
  std::vector<FrameRef> frames;
  while (const base::CsvRow* row = csv.next()) {
    const std::int64_t t_ns = row->nanoseconds_from_seconds(0);
    stamps.add(*row, t_ns);
    frames.push_back({t_ns, file.parent_path() / row->text(1), row->line()});
  }
  require_rows(frames.size(), file);
  return frames;
}

/// Samples of one sensor, in the place of that sensor.
std::vector<ImuSample> read_samples(const fs::path& file, const Bound& bound,
                                    Eigen::Vector3d ImuSample::*place) {
  base::CsvReader csv(file, base::Separator::blanks, {"timestamp [s]", "x", "y", "z"});
  base::RisingStamps stamps;
  std::vector<ImuSample> samples;
  while (const base::CsvRow* row = csv.next()) {
    ImuSample sample;
    sample.t_ns = row->nanoseconds_from_seconds(0);
    stamps.add(*row, sample.t_ns);
    sample.*place = vector_at(*row, 1, bound);
    samples.push_back(sample);
  }
  require_rows(samples.size(), file);
  return samples;
}

/// At the times of the gyroscope at which there is an acceleration before and after.
std::vector<ImuSample> merged(const std::vector<ImuSample>& gyro,
                              const std::vector<ImuSample>& accel) {
  std::vector<ImuSample> samples;
  for (const ImuSample& sample : gyro)
    if (sample.t_ns >= accel.front().t_ns && sample.t_ns <= accel.back().t_ns)
      samples.push_back({sample.t_ns, sample.gyro, interpolate_imu(accel, sample.t_ns).accel});
  return samples;
}

void read_imu(const fs::path& folder, Dataset& data) {
  data.imu_csv = folder / kGyro;
  data.imu_model = read_imu_model(
      required(folder, "imu0/sensor.yaml", "with gyroscope.txt it says rate and noise of the IMU"));
  data.imu = merged(read_samples(data.imu_csv, kGyroBound, &ImuSample::gyro),
                    read_samples(required(folder, kAccel, "expected beside gyroscope.txt"),
                                 kAccelBound, &ImuSample::accel));
  if (data.imu.empty())
    throw InputError(
        fmt::format("{}: no sample within the times of {}", data.imu_csv.string(), kAccel));
}

}  // namespace

bool is_tum_rgbd(const fs::path& folder) { return base::is_file(folder / kFrames); }

Dataset read_tum_rgbd(const fs::path& folder) {
  Dataset data;
  data.frames_csv = folder / kFrames;
  data.pictures = "rgb";
  data.camera = read_camera_model(
      required(folder, "cam0/sensor.yaml",
               "TUM RGB-D folders hold no calibration: expected one as in ASL folders"));
  data.frames = read_frames(data.frames_csv);
  expect_rates(folder, data);
  if (base::is_file(folder / kGyro))
    read_imu(folder, data);
  else
    data.camera.T_body_camera = Eigen::Isometry3d::Identity();
  if (base::exists(folder / kTruth)) {
    data.truth_csv = folder / kTruth;
    const Eigen::Isometry3d T_camera_body = data.camera.T_body_camera.inverse();
    for (const StampedPose& pose : read_tum(data.truth_csv)) {
      GroundTruthPose truth;
      truth.t_ns = pose.t_ns;
      truth.T_world_body = pose.T_world_body * T_camera_body;  // the file's are the camera's
      data.ground_truth.push_back(truth);
    }
  }
  for (const char* name : {"cam0/sensor.yaml", kFrames, "imu0/sensor.yaml", kGyro, kAccel, kTruth})
    if (base::is_file(folder / name)) data.files.push_back({name, {folder / name}});
  take_faulty_pixels(folder / "cam0/sensor.yaml", data);
  return data;
}

}  // namespace leviosim::traces
