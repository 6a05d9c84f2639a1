// sensor.yaml: exact round trip, and the message for each kind of fault.
#include "traces/datasets/sensor_yaml.h"

#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_writer.h"
#include "traces/datasets/euroc_sensors.h"

namespace leviosim::traces {
namespace {

using testing::AslFolder;
using testing::expect_input_error;
using testing::TempFolder;

constexpr const char* kCamera = "cam0/sensor.yaml";
constexpr const char* kImuSensor = "imu0/sensor.yaml";

void expect_broken_camera(const std::string& from, const std::string& to,
                          std::initializer_list<std::string> parts) {
  const AslFolder folder;
  folder.replace(kCamera, from, to);
  expect_input_error([&] { read_camera_model(folder.mav0(kCamera)); }, parts);
}

void expect_broken_imu(const std::string& from, const std::string& to,
                       std::initializer_list<std::string> parts) {
  const AslFolder folder;
  folder.replace(kImuSensor, from, to);
  expect_input_error([&] { read_imu_model(folder.mav0(kImuSensor)); }, parts);
}

TEST(SensorYaml, WhatIsWrittenReadsBackExactly) {
  const TempFolder folder;
  const CameraModel camera = euroc_cam0();
  outputs::write_file_atomically(folder / "sensor.yaml", format_camera_yaml(camera, "c"));
  const CameraModel read = read_camera_model(folder / "sensor.yaml");
  EXPECT_EQ(read.T_body_camera.matrix(), camera.T_body_camera.matrix());
  EXPECT_EQ(read.fx, camera.fx);
  EXPECT_EQ(read.cy, camera.cy);
  EXPECT_EQ(read.k1, camera.k1);
  EXPECT_EQ(read.p2, camera.p2);
  EXPECT_EQ(read.height, camera.height);
  EXPECT_EQ(read.rate_hz, camera.rate_hz);
  outputs::write_file_atomically(folder / "imu.yaml", format_imu_yaml(euroc_imu0(), "c"));
  const ImuModel imu = read_imu_model(folder / "imu.yaml");
  EXPECT_EQ(imu.rate_hz, 200);
  EXPECT_EQ(imu.gyro_noise_density, 1.6968e-4);
  EXPECT_EQ(imu.gyro_random_walk, 1.9393e-5);
  EXPECT_EQ(imu.accel_noise_density, 2e-3);
  EXPECT_EQ(imu.accel_random_walk, 3e-3);
}

TEST(SensorYaml, UnknownModelsListTheSupportedOnes) {
  expect_broken_camera("camera_model: pinhole", "camera_model: omni",
                       {"cam0/sensor.yaml line 15, key 'camera_model'", "'omni'", "pinhole"});
  expect_broken_camera(
      "radial-tangential", "fov",
      {"line 17, key 'distortion_model'", "'fov'", "radial-tangential, equidistant"});
}

TEST(SensorYaml, AnEquidistantLensReadsBack) {
  const testing::TempFolder folder;
  CameraModel camera = euroc_cam0();
  camera.lens = Lens::equidistant;
  camera.p1 = camera.p2 = 0;
  camera.k3 = -0.002;
  camera.k4 = 0.0002;
  outputs::write_file_atomically(folder / "cam.yaml", format_camera_yaml(camera, "c"));
  const CameraModel read = read_camera_model(folder / "cam.yaml");
  EXPECT_EQ(read.lens, Lens::equidistant);
  EXPECT_EQ(read.k1, camera.k1);
  EXPECT_EQ(read.k3, camera.k3);
  EXPECT_EQ(read.k4, camera.k4);
  EXPECT_EQ(read.p1, 0);
}

TEST(SensorYaml, MissingKeyNamesTheNearestOne) {
  expect_broken_camera("resolution:", "resolutoin:",
                       {"cam0/sensor.yaml line 1", "key 'resolution'", "missing", "'resolutoin'"});
  expect_broken_camera("rate_hz: 20\n", "", {"key 'rate_hz'", "is missing"});
  expect_broken_camera("  data:", "  values:", {"key 'T_BS.data'", "is missing"});
  expect_broken_imu("gyroscope_random_walk", "gyro_walk",
                    {"imu0/sensor.yaml", "key 'gyroscope_random_walk'", "is missing"});
}

TEST(SensorYaml, WrongLengthsAndKinds) {
  expect_broken_camera("[32, 24]", "[32]",
                       {"line 14, key 'resolution'", "1 entries", "expected 2"});
  expect_broken_camera("[32, 24]", "32", {"line 14, key 'resolution'", "list of 2 numbers"});
  expect_broken_camera("[20, 21, 15.5, 11.25]", "[20, 21, 15.5]",
                       {"line 16, key 'intrinsics'", "3 entries", "expected 4"});
  expect_broken_camera("-0.2, 0.05, 0.001, -0.002", "-0.2, 0.05, 0.001, -0.002, 0",
                       {"key 'distortion_coefficients'", "5 entries", "expected 4"});
  expect_broken_camera("0, 0, 0, 1]", "0, 0, 0]",
                       {"line 8, key 'T_BS.data'", "15 entries", "expected 16"});
}

TEST(SensorYaml, ImpossibleValues) {
  expect_broken_camera("[32, 24]", "[32, 24.5]", {"key 'resolution'", "24.5", "whole number"});
  expect_broken_camera("[32, 24]", "[0, 24]", {"key 'resolution'"});
  expect_broken_camera("[20, 21,", "[-20, 21,", {"key 'intrinsics'", "above 0"});
  expect_broken_camera("[20, 21,", "[.nan, 21,", {"key 'intrinsics'", "entry 1", "'.nan'"});
  expect_broken_camera("rate_hz: 20", "rate_hz: 0", {"key 'rate_hz'", "above 0"});
  expect_broken_camera("rate_hz: 20", "rate_hz: fast", {"key 'rate_hz'", "'fast'"});
  expect_broken_camera("data: [1, 0", "data: [2, 0", {"key 'T_BS.data'", "not a rotation"});
  expect_broken_camera("0, 0, 0, 1]", "0, 0, 1, 1]", {"key 'T_BS.data'", "last row"});
  expect_broken_imu("gyroscope_noise_density: ", "gyroscope_noise_density: -",
                    {"key 'gyroscope_noise_density'", "not below 0"});
  expect_broken_imu("rate_hz: 200", "rate_hz: [200]", {"key 'rate_hz'", "a list"});
}

TEST(SensorYaml, ValuesOnTheBounds) {
  const auto read = [](const std::string& from, const std::string& to) {
    const AslFolder folder;
    folder.replace(kCamera, from, to);
    return read_camera_model(folder.mav0(kCamera));
  };
  EXPECT_EQ(read("[32, 24]", "[4096, 4096]").width, 4096);
  EXPECT_EQ(read("[32, 24]", "[65535, 256]").width, 65535);
  expect_broken_camera("[32, 24]", "[4096, 4097]", {"line 14, key 'resolution'", "4096x4097"});
  EXPECT_EQ(read("rate_hz: 20", "rate_hz: 0.001").rate_hz, 1e-3);
  EXPECT_EQ(read("rate_hz: 20", "rate_hz: 1e5").rate_hz, 1e5);
  expect_broken_camera("rate_hz: 20", "rate_hz: 100001", {"line 13, key 'rate_hz'", "100001"});
  expect_broken_camera("rate_hz: 20", "rate_hz: 0.0009", {"line 13, key 'rate_hz'", "0.0009"});
  EXPECT_EQ(read("[20, 21,", "[1e6, 21,").fx, 1e6);
  expect_broken_camera("[20, 21,", "[1000001, 21,", {"line 16, key 'intrinsics'", "1000001"});
  expect_broken_camera("0.05, 0.001", "0.05, 1001", {"'distortion_coefficients'", "1001"});
  expect_broken_camera("data: [1, 0, 0, 0", "data: [1, 0, 0, -1001", {"'T_BS.data'", "-1001"});
  expect_broken_imu("gyroscope_random_walk: ", "gyroscope_random_walk: 1001 # ",
                    {"'gyroscope_random_walk'", "1001", "at most 1000"});
}

TEST(SensorYaml, KeysOccurOnceInOneDocument) {
  expect_broken_camera("rate_hz: 20\n", "rate_hz: 20\nrate_hz: 20\n",
                       {"line 14, key 'rate_hz': duplicate key, first given on line 13"});
  expect_broken_camera("  data:", "  data: 1\n  data:", {"key 'T_BS.data': duplicate key"});
  expect_broken_imu("rate_hz: 200\n", "---\nrate_hz: 200\n", {"a second document begins"});
}

TEST(SensorYaml, PreparedImagesAreMarked) {
  const AslFolder folder;
  EXPECT_FALSE(read_camera_model(folder.mav0("cam0/sensor.yaml")).prepared);
  CameraModel camera = folder.camera();
  camera.prepared = true;
  outputs::write_file_atomically(folder.mav0("cam0/sensor.yaml"),
                                 format_camera_yaml(camera, "test"));
  EXPECT_TRUE(read_camera_model(folder.mav0("cam0/sensor.yaml")).prepared);
  folder.replace("cam0/sensor.yaml", "prepared: true", "prepared: maybe");
  expect_input_error([&] { read_camera_model(folder.mav0("cam0/sensor.yaml")); },
                     {"key 'prepared'", "'maybe'", "true or false"});
}

TEST(SensorYaml, TheImuMustBeTheBody) {
  expect_broken_imu("data: [1, 0, 0, 0", "data: [1, 0, 0, 0.1", {"key 'T_BS'", "identity"});
}

TEST(SensorYaml, NoYamlAtAll) {
  expect_broken_camera("sensor_type: camera", "sensor_type: [camera",
                       {"cam0/sensor.yaml line", "not valid YAML"});
  const TempFolder folder;
  outputs::write_file_atomically(folder / "sensor.yaml", "just a text\n");
  expect_input_error([&] { read_camera_model(folder / "sensor.yaml"); }, {"a single value"});
  expect_input_error([&] { read_camera_model(folder / "none.yaml"); }, {"cannot be opened"});
}

}  // namespace
}  // namespace leviosim::traces
