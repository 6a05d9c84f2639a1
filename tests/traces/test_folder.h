// Helpers of the traces tests: temporary folders, expected errors, a small valid ASL folder to
// break.
#pragma once

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/outputs/file_system.h"
#include "tests/support/paths.h"
#include "tests/support/temporary_folder.h"
#include "traces/datasets/asl_writer.h"
#include "traces/datasets/image_file.h"

namespace leviosim::traces::testing {

using TempFolder = tests::Scratch;

/// Runs something that must throw an InputError whose message contains all the parts.
inline void expect_input_error(const std::function<void()>& run,
                               std::initializer_list<std::string> parts) {
  try {
    run();
  } catch (const InputError& error) {
    for (const std::string& part : parts)
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
          << "'" << part << "' is not in: " << error.what();
    return;
  }
  ADD_FAILURE() << "no InputError was thrown";
}

/// Every file below a folder with its bytes, but for the record of what leviosim wrote.
inline std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().filename() != ".leviosim-files")
      files[std::filesystem::relative(entry.path(), folder).string()] =
          base::read_text_file(entry.path());
  return files;
}

/// Recorded flights: $LEVIOSIM_DATA or the folder shared/data beside the project.
inline std::filesystem::path recorded_data() {
  const char* folder = std::getenv("LEVIOSIM_DATA");
  if (folder != nullptr) return folder;
  return leviosim::tests::source_folder() / ".." / "shared" / "data";
}

/// A valid ASL folder: six 32x24 frames at 20 Hz from `kStartNs`, IMU and truth at 200 Hz from 50
/// ms before to 50 ms after them. Tests then break one thing.
class AslFolder {
 public:
  static constexpr std::int64_t kStartNs = 5'000'000'000;
  static constexpr int kFrames = 6;

  AslFolder() {
    camera_.fx = 20;
    camera_.fy = 21;
    camera_.cx = 15.5;
    camera_.cy = 11.25;
    camera_.k1 = -0.2;
    camera_.k2 = 0.05;
    camera_.p1 = 0.001;
    camera_.p2 = -0.002;
    camera_.width = 32;
    camera_.height = 24;
    camera_.rate_hz = 20;
    imu_.rate_hz = 200;
    imu_.gyro_noise_density = 1e-4;
    imu_.gyro_random_walk = 2e-5;
    imu_.accel_noise_density = 2e-3;
    imu_.accel_random_walk = 3e-3;
    write_streams();
    write_images();
  }

  std::filesystem::path root() const { return folder_.path(); }
  std::filesystem::path mav0(const std::string& name) const { return folder_ / ("mav0/" + name); }
  const CameraModel& camera() const { return camera_; }
  static std::int64_t frame_ns(int i) { return kStartNs + i * 50'000'000; }
  std::filesystem::path image(int i) const { return mav0("cam0/data/" + image_name(frame_ns(i))); }

  /// Replaces line `line` (from 1) of a file; a text with line breaks inserts lines.
  void set_line(const std::string& name, std::size_t line, const std::string& text) const {
    edit(name, [&](std::vector<std::string>& lines) { lines.at(line - 1) = text; });
  }
  void remove_lines(const std::string& name, std::size_t first, std::size_t count) const {
    edit(name, [&](std::vector<std::string>& lines) {
      const auto begin = lines.begin() + static_cast<std::ptrdiff_t>(first - 1);
      lines.erase(begin, begin + static_cast<std::ptrdiff_t>(count));
    });
  }
  void replace(const std::string& name, const std::string& from, const std::string& to) const {
    std::string text = base::read_text_file(mav0(name));
    const auto position = text.find(from);
    ASSERT_NE(position, std::string::npos) << from;
    text.replace(position, from.size(), to);
    outputs::write_file_atomically(mav0(name), text);
  }

 private:
  void edit(const std::string& name,
            const std::function<void(std::vector<std::string>&)>& change) const {
    std::vector<std::string> lines;
    std::ifstream in(mav0(name));
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    change(lines);
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    outputs::write_file_atomically(mav0(name), text);
  }

  void write_streams() {
    std::vector<std::int64_t> frames;
    for (int i = 0; i < kFrames; ++i) frames.push_back(frame_ns(i));
    std::vector<ImuSample> samples;
    std::vector<GroundTruthPose> truth;
    for (int i = -10; i <= (kFrames - 1) * 10 + 10; ++i) {
      const std::int64_t t_ns = kStartNs + i * 5'000'000;
      samples.push_back({t_ns, {0.01 * i, 0.2, -0.3}, {0.1, 9.81, 0.001 * i}});
      GroundTruthPose pose;
      pose.t_ns = t_ns;
      pose.T_world_body = Eigen::Translation3d(0.1 * i, 1, 2) *
                          Eigen::AngleAxisd(0.05 * i, Eigen::Vector3d(1, 2, 2) / 3);
      pose.velocity = {20, 0, 0};
      pose.bias_gyro = {0.01, 0.02, 0.03};
      pose.bias_accel = {0.1, 0.2, 0.3};
      truth.push_back(pose);
    }
    for (const char* name : {"cam0/data", "imu0", "state_groundtruth_estimate0"})
      std::filesystem::create_directories(mav0(name));
    outputs::write_file_atomically(mav0("cam0/sensor.yaml"), format_camera_yaml(camera_, "test"));
    outputs::write_file_atomically(mav0("cam0/data.csv"), format_frames_csv(frames));
    outputs::write_file_atomically(mav0("imu0/sensor.yaml"), format_imu_yaml(imu_, "test"));
    outputs::write_file_atomically(mav0("imu0/data.csv"), format_imu_csv(samples));
    outputs::write_file_atomically(mav0("state_groundtruth_estimate0/data.csv"),
                                   format_ground_truth_csv(truth));
  }

  void write_images() {
    for (int i = 0; i < kFrames; ++i) {
      std::vector<std::uint8_t> picture;
      for (int y = 0; y < camera_.height; ++y)
        for (int x = 0; x < camera_.width; ++x)
          picture.push_back(static_cast<std::uint8_t>((x * 37 + y * 91 + i * 13) % 251));
      outputs::write_file_atomically(image(i),
                                     encode_png({camera_.width, camera_.height}, picture));
    }
  }

  TempFolder folder_;
  CameraModel camera_;
  ImuModel imu_;
};

}  // namespace leviosim::traces::testing
