// Reading of the two sensor.yaml files of an ASL folder, and of the same facts in the files of the
// calibration program Kalibr. Strict where it matters: a missing key, a
// list of the wrong length or an unsupported model is an InputError that names file, line and key;
// keys that are not needed (comments, extra entries) are passed over.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/yaml_document.h"
#include "traces/datasets/camera_model.h"
#include "traces/datasets/dataset.h"

namespace leviosim::traces {

/// The largest picture that is read: 4096x4096, which is beyond the cameras that odometry uses, and
/// of which a picture and the tables that undistort it take 120 MB.
constexpr int kMostPixels = 1 << 24;

/// Reads cam0/sensor.yaml. Supported: camera_model pinhole, distortion_model radial-tangential and
/// equidistant. The optional key `prepared: true` is ours: CameraModel::prepared.
CameraModel read_camera_model(const std::filesystem::path& sensor_yaml);

/// Holds the rates that cam0/sensor.yaml and imu0/sensor.yaml in the folder state against the
/// median periods of frames and samples, where there are three.
void expect_rates(const std::filesystem::path& folder, const Dataset& data);

/// Reads imu0/sensor.yaml. Its T_BS must be the identity: the body frame is the IMU frame.
ImuModel read_imu_model(const std::filesystem::path& sensor_yaml);

/// The camera cam0 of a chain as Kalibr writes it, without its rate, which the file does not hold;
/// `time_shift_s` is what has to be added to its time stamps to get the IMU's.
CameraModel read_kalibr_camera(const std::filesystem::path& camchain_yaml, double& time_shift_s);
/// Kalibr's description of an IMU.
ImuModel read_kalibr_imu(const std::filesystem::path& imu_yaml);

// Strict access to one YAML mapping: every fault is an InputError that names file, line and key.

class YamlMap {
 public:
  /// Parses a file whose root is a mapping. Throws InputError if it cannot be read or parsed.
  static YamlMap load(const std::filesystem::path& file);

  std::string text(const std::string& key) const;
  /// A finite number.
  double number(const std::string& key) const;
  /// A number above zero, from `least` to `most`.
  double positive(const std::string& key, double least, double most) const;
  /// A number from zero to `most`.
  double not_negative(const std::string& key, double most) const;
  /// true or false; `by_default` if the key is not there.
  bool flag(const std::string& key, bool by_default) const;
  bool has(const std::string& key) const { return find(key) != nullptr; }
  /// A list of exactly `size` finite numbers; `meaning` says what they are.
  std::vector<double> numbers(const std::string& key, std::size_t size,
                              std::string_view meaning) const;
  /// A list of `rows` lists of `columns` finite numbers each, row by row.
  std::vector<double> matrix(const std::string& key, std::size_t rows, std::size_t columns) const;
  YamlMap map(const std::string& key) const;

  /// Throws an InputError about the value of a key: "FILE line N, key 'key': MESSAGE".
  [[noreturn]] void fail(const std::string& key, std::string_view message) const;

 private:
  YamlMap(std::filesystem::path file, std::string prefix, const base::YamlNode& node);
  const base::YamlEntry* find(const std::string& key) const;
  std::vector<double> numbers_of(const base::YamlNode& node, const std::string& key,
                                 std::size_t size, std::string_view meaning) const;
  base::YamlNode require(const std::string& key) const;
  std::string nearest_key(const std::string& key) const;
  [[noreturn]] void fail_at(int line, const std::string& key, std::string_view message) const;

  std::filesystem::path file_;
  std::string prefix_;  // of nested keys, "T_BS."
  int line_;            // where it begins
  std::vector<base::YamlEntry> entries_;
};

}  // namespace leviosim::traces
