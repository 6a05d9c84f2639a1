#include "traces/datasets/sensor_yaml.h"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "traces/datasets/sensor_map.h"

namespace leviosim::traces {
namespace {

// EuRoC prints T_BS with 12 digits; 1e-4 also admits hand-made files with 5.
constexpr double kRotationTolerance = 1e-4;

// Far beyond what is built, and small enough that periods, pixels and variances stay numbers.
constexpr double kMostFocalPixels = 1e6;  // of the image centre, too
constexpr double kMostDistortion = 1e3;
constexpr double kMostArmM = 1e3;   // from the body to a sensor
constexpr double kMostNoise = 1e3;  // densities and random walks, in their units

void require_within(const YamlMap& map, const std::string& key, const std::vector<double>& values,
                    double most) {
  for (const double value : values)
    if (std::abs(value) > most)
      map.fail(key, fmt::format("{} is beyond what is possible; expected from {} to {}", value,
                                -most, most));
}

/// A 4×4 rigid transform. @param data  row by row
Eigen::Isometry3d read_transform(const YamlMap& map, const std::string& key,
                                 const std::vector<double>& data) {
  using Matrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Eigen::Matrix4d matrix = Eigen::Map<const Matrix>(data.data());
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const Eigen::RowVector4d last_row(0, 0, 0, 1);
  const double skew = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (skew > kRotationTolerance || rotation.determinant() < 0)
    map.fail(key, "its upper left 3x3 block is not a rotation");
  if (matrix.row(3) != last_row) map.fail(key, "its last row is not 0, 0, 0, 1");
  require_within(map, key, {matrix(0, 3), matrix(1, 3), matrix(2, 3)}, kMostArmM);
  return Eigen::Isometry3d(matrix);
}

/// T_BS, row by row.
Eigen::Isometry3d read_extrinsics(const YamlMap& sensor) {
  const YamlMap block = sensor.map("T_BS");
  return read_transform(block, "data", block.numbers("data", 16, "a 4x4 matrix, row by row"));
}

int read_pixels(const YamlMap& sensor, double value) {
  constexpr double kMost = 65535;
  if (value < 1 || value > kMost || value != std::floor(value))
    sensor.fail("resolution",
                fmt::format("{} is not a whole number of pixels (1 ... {})", value, kMost));
  return static_cast<int>(value);
}

/// A model by its name in sensor.yaml. @returns its index in `supported`
std::size_t read_model(const YamlMap& sensor, const std::string& key,
                       const std::vector<std::string>& supported) {
  const std::string found = sensor.text(key);
  const auto it = std::find(supported.begin(), supported.end(), found);
  if (it == supported.end())
    sensor.fail(key, fmt::format("'{}' is not supported; supported: {}", found,
                                 fmt::join(supported, ", ")));
  return static_cast<std::size_t>(it - supported.begin());
}

/// Lens, focal lengths and size, which both kinds of files have. @param models  what they call the
/// lenses: radial-tangential, equidistant. @param distortion  the key of its coefficients
CameraModel read_lens(const YamlMap& sensor, const std::vector<std::string>& models,
                      const std::string& distortion) {
  read_model(sensor, "camera_model", {"pinhole"});
  const std::size_t model = read_model(sensor, "distortion_model", models);
  const auto resolution = sensor.numbers("resolution", 2, "width, height");
  const auto intrinsics = sensor.numbers("intrinsics", 4, "fu, fv, cu, cv");
  const auto coefficients =
      sensor.numbers(distortion, 4, model == 0 ? "k1, k2, p1, p2" : "k1, k2, k3, k4");
  if (intrinsics[0] <= 0 || intrinsics[1] <= 0)
    sensor.fail("intrinsics", "the focal lengths fu, fv must be above 0");
  require_within(sensor, "intrinsics", intrinsics, kMostFocalPixels);
  require_within(sensor, distortion, coefficients, kMostDistortion);

  CameraModel camera;
  camera.fx = intrinsics[0];
  camera.fy = intrinsics[1];
  camera.cx = intrinsics[2];
  camera.cy = intrinsics[3];
  camera.k1 = coefficients[0];
  camera.k2 = coefficients[1];
  camera.lens = model == 0 ? Lens::radial_tangential : Lens::equidistant;
  (model == 0 ? camera.p1 : camera.k3) = coefficients[2];
  (model == 0 ? camera.p2 : camera.k4) = coefficients[3];
  camera.width = read_pixels(sensor, resolution[0]);
  camera.height = read_pixels(sensor, resolution[1]);
  if (static_cast<std::int64_t>(camera.width) * camera.height > kMostPixels)
    sensor.fail("resolution", fmt::format("{}x{} is more than {} pixels, the most that is read",
                                          camera.width, camera.height, kMostPixels));
  return camera;
}

/// Kalibr's key: t_imu = t_camera + shift. [s]; 0 where it is not given
double read_time_shift(const YamlMap& sensor) {
  constexpr double kLongestShiftS = 10;
  const std::string key = "timeshift_cam_imu";
  if (!sensor.has(key)) return 0;
  const double shift_s = sensor.number(key);
  require_within(sensor, key, {shift_s}, kLongestShiftS);
  return shift_s;
}

ImuModel read_noise(const YamlMap& sensor, const std::string& rate) {
  ImuModel imu;
  imu.rate_hz = sensor.positive(rate, kLeastHz, kMostHz);
  imu.gyro_noise_density = sensor.not_negative("gyroscope_noise_density", kMostNoise);
  imu.gyro_random_walk = sensor.not_negative("gyroscope_random_walk", kMostNoise);
  imu.accel_noise_density = sensor.not_negative("accelerometer_noise_density", kMostNoise);
  imu.accel_random_walk = sensor.not_negative("accelerometer_random_walk", kMostNoise);
  return imu;
}

}  // namespace

CameraModel read_camera_model(const std::filesystem::path& sensor_yaml) {
  const YamlMap sensor = YamlMap::load(sensor_yaml);
  CameraModel camera =
      read_lens(sensor, {"radial-tangential", "equidistant"}, "distortion_coefficients");
  camera.T_body_camera = read_extrinsics(sensor);
  camera.rate_hz = sensor.positive("rate_hz", kLeastHz, kMostHz);
  camera.prepared = sensor.flag("prepared", false);
  camera.time_shift_s = read_time_shift(sensor);
  return camera;
}

void take_faulty_pixels(const std::filesystem::path& sensor_yaml, Dataset& data) {
  const YamlMap sensor = YamlMap::load(sensor_yaml);
  const std::string key = "faulty_pixels";
  if (!sensor.has(key)) return;
  const std::filesystem::path name = sensor.text(key);
  if (name.empty() || name != name.filename())
    sensor.fail(key, "expected the name of a picture in the same folder");
  const std::filesystem::path mask = sensor_yaml.parent_path() / name;
  data.faulty_pixels = read_faulty_pixels(mask, {data.camera.width, data.camera.height});
  data.files.push_back({"mask of faulty pixels", {mask}});
}

namespace {

void expect_rate(const std::filesystem::path& sensor_yaml, double stated_hz,
                 const std::vector<std::int64_t>& stamps_ns, const std::filesystem::path& csv) {
  constexpr std::size_t kFewest = 3;
  constexpr double kMostOff = 0.1;
  if (stamps_ns.size() < kFewest) return;
  const double found = rate_of(stamps_ns, csv);
  if (std::abs(stated_hz / found - 1) <= kMostOff) return;
  YamlMap::load(sensor_yaml)
      .fail("rate_hz", fmt::format("is {:g}; expected {:.4g}, since rows of {} are {:.4g} ms "
                                   "apart, most of them",
                                   stated_hz, found, csv.string(), 1e3 / found));
}

}  // namespace

void expect_rates(const std::filesystem::path& folder, const Dataset& data) {
  expect_rate(folder / "cam0/sensor.yaml", data.camera.rate_hz, stamps_of(data.frames),
              data.frames_csv);
  std::vector<std::int64_t> samples_ns;
  for (const ImuSample& sample : data.imu) samples_ns.push_back(sample.t_ns);
  expect_rate(folder / "imu0/sensor.yaml", data.imu_model.rate_hz, samples_ns, data.imu_csv);
}

ImuModel read_imu_model(const std::filesystem::path& sensor_yaml) {
  const YamlMap sensor = YamlMap::load(sensor_yaml);
  ImuModel imu = read_noise(sensor, "rate_hz");
  constexpr double kLeastScale = 0.5, kMostScale = 2;
  const std::string scale = "accelerometer_scale";
  if (sensor.has(scale)) imu.accel_scale = sensor.positive(scale, kLeastScale, kMostScale);
  if (!read_extrinsics(sensor).isApprox(Eigen::Isometry3d::Identity(), kRotationTolerance))
    sensor.fail("T_BS", "must be the identity: the body frame is taken to be the IMU frame");
  return imu;
}

CameraModel read_kalibr_camera(const std::filesystem::path& camchain_yaml) {
  const YamlMap sensor = YamlMap::load(camchain_yaml).map("cam0");
  CameraModel camera = read_lens(sensor, {"radtan", "equidistant"}, "distortion_coeffs");
  camera.T_body_camera =
      read_transform(sensor, "T_cam_imu", sensor.matrix("T_cam_imu", 4, 4)).inverse();
  camera.time_shift_s = read_time_shift(sensor);
  return camera;
}

ImuModel read_kalibr_imu(const std::filesystem::path& imu_yaml) {
  return read_noise(YamlMap::load(imu_yaml), "update_rate");
}

void apply_calibration(Dataset& data) {
  const std::int64_t shift_ns = std::llround(1e9 * data.camera.time_shift_s);
  for (FrameRef& frame : data.frames) frame.t_ns += shift_ns;
  for (ImuSample& sample : data.imu) sample.accel *= data.imu_model.accel_scale;
}

}  // namespace leviosim::traces
