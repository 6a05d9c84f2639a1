// Reading, undistorting and decimating, against OpenCV and the published numbers.
#include "traces/datasets/image_source.h"
#include "traces/datasets/image_preparation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "tests/support/image_files.h"
#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/euroc_sensors.h"
#include "traces/datasets/image_file.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;
using testing::AslFolder;
using testing::expect_input_error;

/// The whole frame, undistorted by OpenCV.
cv::Mat undistorted(const CameraModel& camera, const fs::path& image) {
  const cv::Mat matrix =
      (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Mat coefficients =
      (cv::Mat_<double>(4, 1) << camera.k1, camera.k2, camera.p1, camera.p2);
  cv::Mat result;
  cv::undistort(tests::decoded(base::read_text_file(image), {camera.width, camera.height}), result,
                matrix, coefficients);
  return result;
}

TEST(Decimation, FollowsThePublishedRule) {
  const Decimation quarter = make_decimation(euroc_cam0(), {160, 120});
  EXPECT_EQ(quarter.factor, 4);
  EXPECT_EQ(quarter.x0 + quarter.shift, 57);
  EXPECT_EQ(quarter.y0 + quarter.shift, 1);
  const Decimation full = make_decimation(euroc_cam0(), {752, 480});
  EXPECT_EQ(full.factor, 1);
  EXPECT_EQ(full.x0 + full.shift, 0);
  EXPECT_EQ(full.y0 + full.shift, 0);
  const Decimation half = make_decimation(euroc_cam0(), {320, 240});
  EXPECT_EQ(half.factor, 2);
  EXPECT_EQ(half.x0 + half.shift, 57);
  EXPECT_EQ(half.y0 + half.shift, 1);
}

TEST(Decimation, IntrinsicsAreThePublishedOnes) {
  const ImageSize size{160, 120};
  const PinholeIntrinsics k =
      decimated_intrinsics(euroc_cam0(), size, make_decimation(euroc_cam0(), size));
  EXPECT_NEAR(k.fx, 114.66, 0.005);
  EXPECT_NEAR(k.fy, 114.32, 0.005);
  EXPECT_NEAR(k.cx, 77.80, 0.005);
  EXPECT_NEAR(k.cy, 62.09, 0.005);
  EXPECT_EQ(k.width, 160);
  EXPECT_EQ(k.height, 120);
}

TEST(Decimation, EverySizeStaysWithinTheImage) {
  const CameraModel camera = euroc_cam0();
  for (int width = 1; width <= camera.width; width += 3) {
    for (int height = 1; height <= camera.height; height += 7) {
      const Decimation d = make_decimation(camera, {width, height});
      ASSERT_GE(std::min(d.x0, d.y0), 0);
      ASSERT_LT(d.x0 + d.shift + d.factor * (width - 1), camera.width);
      ASSERT_LT(d.y0 + d.shift + d.factor * (height - 1), camera.height);
    }
  }
}

TEST(Decimation, RefusesSizesThatDoNotFit) {
  for (const ImageSize size :
       {ImageSize{0, 120}, ImageSize{160, -1}, ImageSize{753, 480}, ImageSize{160, 481}})
    expect_input_error([&] { make_decimation(euroc_cam0(), size); },
                       {fmt::format("{}x{}", size.width, size.height), "752x480"});
}

TEST(ImageSource, PixelsAreThoseOfOpenCvsUndistortedImage) {
  const AslFolder folder;
  const Dataset data = open_asl(folder.root());
  const cv::Mat full = undistorted(data.camera, folder.image(2));
  const ImageSource source(data, {7, 5});  // k = 4; window 28x20 at (2, 2); samples shifted by 1
  const GrayImage image = source.read(2);
  EXPECT_EQ(image.t_ns, AslFolder::frame_ns(2));
  ASSERT_EQ(image.pixels.size(), 35u);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x)
      EXPECT_EQ(image.pixels[y * 7 + x], full.at<uchar>(3 + 4 * y, 3 + 4 * x)) << x << " " << y;
}

TEST(ImageSource, FullSizeIsTheUndistortedImage) {
  const AslFolder folder;
  const Dataset data = open_asl(folder.root());
  const cv::Mat full = undistorted(data.camera, folder.image(0));
  const GrayImage image = ImageSource(data, {32, 24}).read(0);
  EXPECT_TRUE(std::equal(image.pixels.begin(), image.pixels.end(), full.begin<uchar>()));
}

TEST(ImageSource, RecordedFrameDecimated) {
  const fs::path folder = testing::recorded_data() / "euroc" / "MH_01_easy_t05_t20";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const Dataset data = open_asl(folder);
  const cv::Mat full = undistorted(data.camera, data.frames[123].path);
  const GrayImage image = ImageSource(data, {160, 120}).read(123);
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x)
      ASSERT_EQ(image.pixels[y * 160 + x], full.at<uchar>(1 + 4 * y, 57 + 4 * x));
}

TEST(ImageSource, SharesPreparedPicturesWithSourcesOfTheSameMaking) {
  const AslFolder folder;
  const Dataset data = open_asl(folder.root());
  const GrayImage alone = ImageSource(data, {7, 5}).read(1);
  const auto memory = std::make_shared<PictureMemory>();
  EXPECT_EQ(ImageSource(data, {7, 5}, memory).read(1).pixels, alone.pixels);
  fs::remove(folder.image(1));
  EXPECT_EQ(ImageSource(data, {7, 5}, memory).read(1).pixels, alone.pixels);
  EXPECT_THROW(ImageSource(data, {8, 6}, memory).read(1), InputError);
  Dataset other = data;
  other.camera.fx += 1;
  EXPECT_THROW(ImageSource(other, {7, 5}, memory).read(1), InputError);
}

TEST(PictureMemory, KeepsNoMoreThanItMay) {
  PictureMemory memory(10);
  memory.keep("a", std::vector<std::uint8_t>(6, 1));
  memory.keep("b", std::vector<std::uint8_t>(6, 2));
  EXPECT_EQ(memory.find("a"), std::vector<std::uint8_t>(6, 1));
  EXPECT_EQ(memory.find("b"), std::nullopt);
}

TEST(ImageSource, ThreadsReadTheSame) {
  const AslFolder folder;
  const ImageSource source(open_asl(folder.root()), {16, 12});
  std::vector<GrayImage> parallel(source.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < source.size(); ++i)
    threads.emplace_back([&, i] { parallel[i] = source.read(i); });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < source.size(); ++i)
    EXPECT_EQ(parallel[i].pixels, source.read(i).pixels);
}

/// Writes something else in place of frame 1 and expects an error that names its row.
void expect_bad_image(const cv::Mat& image, std::initializer_list<std::string> parts) {
  const AslFolder folder;
  outputs::write_file_atomically(folder.image(1), tests::png_of(image));
  const ImageSource source(open_asl(folder.root()), {16, 12});
  EXPECT_NO_THROW(source.read(0));
  expect_input_error([&] { source.read(1); }, {"5050000000.png", "cam0/data.csv line 3"});
  expect_input_error([&] { source.read(1); }, parts);
}

TEST(ImageSource, WrongImages) {
  expect_bad_image(cv::Mat(24, 33, CV_8UC1, 7.0), {"33x24", "32x24"});
}

TEST(ImageSource, BrokenImages) {
  const AslFolder folder;
  outputs::write_file_atomically(folder.image(1), "this is no picture");
  fs::resize_file(folder.image(2), fs::file_size(folder.image(2)) / 2);
  const ImageSource source(open_asl(folder.root()), {16, 12});
  expect_input_error([&] { source.read(1); },
                     {"cam0/data.csv line 3", "cannot be read as an image"});
  expect_input_error([&] { source.read(2); },
                     {"cam0/data.csv line 4", "cannot be read as an image"});
}

}  // namespace
}  // namespace leviosim::traces
