// The synthetic flight as a folder: complete, reproducible, readable, and rich in corners.
#include "traces/synthesis/synthetic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <opencv2/features2d.hpp>
#include <stdexcept>

#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/image_source.h"
#include "traces/datasets/imu_samples.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;
using testing::contents;
using testing::expect_input_error;
using testing::TempFolder;

/// Small pictures and coarse textures: quick to make.
SyntheticOptions small_flight() {
  SyntheticOptions options;
  options.duration_s = 1.5;
  options.texel_m = 0.03;
  options.camera.fx /= 8;
  options.camera.fy /= 8;
  options.camera.cx /= 8;
  options.camera.cy /= 8;
  options.camera.width = 94;
  options.camera.height = 60;
  return options;
}

TEST(Synthetic, SameSeedSameBytesOnAnyNumberOfThreads) {
  const TempFolder folder;
  SyntheticOptions options = small_flight();
  options.threads = 1;
  write_synthetic_flight(folder / "a", options);
  options.threads = 3;
  write_synthetic_flight(folder / "b", options);
  options.seed = 2;
  write_synthetic_flight(folder / "c", options);
  const auto a = contents(folder / "a");
  EXPECT_EQ(a.size(), 6u + 30u);
  EXPECT_TRUE(a == contents(folder / "b"));
  const auto c = contents(folder / "c");
  for (const char* name :
       {"imu0/data.csv", "state_groundtruth_estimate0/data.csv", "cam0/data/1000000000000.png"})
    EXPECT_NE(a.at(std::string("mav0/") + name), c.at(std::string("mav0/") + name)) << name;
}

TEST(Synthetic, StreamsFitTogether) {
  const TempFolder folder;
  write_synthetic_flight(folder / "a", small_flight());
  const Dataset data = open_asl(folder / "a");
  EXPECT_EQ(data.frames.size(), 30u);
  EXPECT_EQ(data.frames.front().t_ns, SyntheticOptions::kFirstFrameNs);
  EXPECT_EQ(data.frames.back().t_ns, SyntheticOptions::kFirstFrameNs + 29 * 50'000'000);
  EXPECT_EQ(data.imu.size(), 301u);
  ASSERT_EQ(data.ground_truth.size(), data.imu.size());
  for (std::size_t i = 0; i < data.imu.size(); ++i)
    EXPECT_EQ(data.imu[i].t_ns, data.ground_truth[i].t_ns);
  for (std::size_t i = 0; i < data.frames.size(); ++i) EXPECT_EQ(imu_batch(data, i).size(), 10u);
  EXPECT_EQ(ImageSource(data, {94, 60}).read(29).pixels.size(), 94u * 60u);
}

TEST(Synthetic, TheFirstSecondIsAtRest) {
  const TempFolder folder;
  write_synthetic_flight(folder / "a", small_flight());
  const Dataset data = open_asl(folder / "a");
  const auto& first = data.ground_truth.front().T_world_body;
  for (const GroundTruthPose& pose : data.ground_truth) {
    const bool resting = pose.t_ns <= SyntheticOptions::kFirstFrameNs + 1'000'000'000;
    if (!resting) continue;
    EXPECT_EQ(pose.T_world_body.matrix(), first.matrix());
    EXPECT_EQ(pose.velocity, Eigen::Vector3d::Zero());
  }
  EXPECT_NE(data.ground_truth.back().T_world_body.matrix(), first.matrix());
}

TEST(Synthetic, PerfectImuHasNoBias) {
  const TempFolder folder;
  SyntheticOptions options = small_flight();
  options.imu_errors = false;
  write_synthetic_flight(folder / "a", options);
  const Dataset data = open_asl(folder / "a");
  EXPECT_EQ(data.imu.front().gyro, Eigen::Vector3d::Zero());
  EXPECT_NEAR(data.imu.front().accel.norm(), 9.81, 1e-9);
  EXPECT_EQ(data.ground_truth.back().bias_accel, Eigen::Vector3d::Zero());
}

TEST(Synthetic, OverwritesOnlyWhatItMay) {
  const TempFolder folder;
  SyntheticOptions options = small_flight();
  options.duration_s = 0.1;
  write_synthetic_flight(folder / "a", options);
  expect_input_error([&] { write_synthetic_flight(folder / "a", options); },
                     {"a: exists and holds results", "--force"});
  options.overwrite = true;
  options.duration_s = 0.2;
  write_synthetic_flight(folder / "a", options);
  EXPECT_EQ(open_asl(folder / "a").frames.size(), 4u);
  fs::create_directories(folder / "home/precious");
  expect_input_error([&] { write_synthetic_flight(folder / "home", options); },
                     {"home", "something other than results: precious"});
  EXPECT_TRUE(fs::exists(folder / "home/precious"));
}

TEST(Synthetic, ACacheIsRepairedAlsoIfItWasChanged) {
  const TempFolder folder;
  SyntheticOptions options = small_flight();
  options.duration_s = 0.1;
  write_synthetic_flight(folder / "a", options);
  const auto drawn = contents(folder / "a");
  outputs::write_file_atomically(folder / "a/mav0/imu0/data.csv", "damaged");
  options.overwrite = true;
  expect_input_error([&] { write_synthetic_flight(folder / "a", options); }, {"imu0/data.csv"});
  options.repair = true;
  write_synthetic_flight(folder / "a", options);
  EXPECT_TRUE(contents(folder / "a") == drawn);
}

TEST(Synthetic, NothingIsLeftOfAFailure) {
  const TempFolder folder;
  const auto stop = [](std::size_t done, std::size_t) {
    if (done == 2) throw std::runtime_error("stop");
  };
  EXPECT_THROW(write_synthetic_flight(folder / "a", small_flight(), stop), std::runtime_error);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Synthetic, ReportsProgress) {
  const TempFolder folder;
  SyntheticOptions options = small_flight();
  options.duration_s = 0.3;
  std::vector<std::size_t> told;
  write_synthetic_flight(folder / "a", options, [&](std::size_t done, std::size_t total) {
    EXPECT_EQ(total, 6u);
    told.push_back(done);
  });
  EXPECT_EQ(told, (std::vector<std::size_t>{1, 2, 3, 4, 5, 6}));
}

TEST(Synthetic, RefusesImpossibleOptions) {
  const TempFolder folder;
  SyntheticOptions options = small_flight();
  options.duration_s = 0;
  expect_input_error([&] { write_synthetic_flight(folder / "a", options); }, {"duration 0 s"});
  options = small_flight();
  options.image_noise = -1;
  expect_input_error([&] { write_synthetic_flight(folder / "a", options); }, {"image noise -1"});
  options = small_flight();
  options.texel_m = 0;
  expect_input_error([&] { write_synthetic_flight(folder / "a", options); }, {"texel 0 m"});
}

/// Corners as the detector of the `levio` profile would keep them: FAST-9 with threshold 20 at
/// 160x120, at most 4 in each 8x8 cell, none within 16 px of the border.
int count_keypoints(GrayImage& image) {
  const cv::Mat view(image.height, image.width, CV_8UC1, image.pixels.data());
  std::vector<cv::KeyPoint> corners;
  cv::FAST(view, corners, 20, false, cv::FastFeatureDetector::TYPE_9_16);
  std::map<std::pair<int, int>, int> cells;
  for (const cv::KeyPoint& corner : corners) {
    const int x = static_cast<int>(corner.pt.x) - 16;
    const int y = static_cast<int>(corner.pt.y) - 16;
    if (x >= 0 && y >= 0 && x < 128 && y < 88) ++cells[{x / 8, y / 8}];
  }
  int count = 0;
  for (const auto& cell : cells) count += std::min(4, cell.second);
  return count;
}

TEST(Synthetic, HasAsManyCornersAsTheRecordedFlights) {
  const TempFolder folder;
  SyntheticOptions options;
  options.camera.rate_hz = 0.5;  // ten frames, two seconds apart
  write_synthetic_flight(folder / "a", options);
  const ImageSource source(open_asl(folder / "a"), {160, 120});
  ASSERT_EQ(source.size(), 10u);
  int sum = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    GrayImage image = source.read(i);
    const int count = count_keypoints(image);
    EXPECT_GT(count, 220) << "frame " << i;
    EXPECT_LT(count, 580) << "frame " << i;
    sum += count;
  }
  EXPECT_NEAR(sum / 10.0, 400, 80);
}

}  // namespace
}  // namespace leviosim::traces
