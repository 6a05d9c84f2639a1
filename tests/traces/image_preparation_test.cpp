// Prepared images: which pixels they come from, and that they need no second preparation. What the
// pixels must be is held by image_source_test.cpp.
#include "traces/datasets/image_preparation.h"

#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_writer.h"
#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

cv::Mat random_image(const CameraModel& camera, std::uint64_t seed) {
  Rng rng(seed);
  cv::Mat image(camera.height, camera.width, CV_8UC1);
  for (auto it = image.begin<uchar>(); it != image.end<uchar>(); ++it)
    *it = static_cast<uchar>(rng.below(256));
  return image;
}

TEST(ImagePreparation, ReadsNoPixelButThoseItNames) {
  const CameraModel camera = euroc_cam0();
  for (const ImageSize size : {ImageSize{160, 120}, {320, 240}, {752, 480}}) {
    const ImagePreparation preparation(camera, size);
    const cv::Mat image = random_image(camera, 1);
    cv::Mat spoiled = random_image(camera, 2);
    const std::vector<std::uint8_t> read = preparation.pixels_read();
    image.copyTo(spoiled, cv::Mat(image.size(), CV_8UC1, const_cast<std::uint8_t*>(read.data())));
    EXPECT_EQ(preparation.apply(image), preparation.apply(spoiled)) << size.width;
  }
  const std::vector<std::uint8_t> read = ImagePreparation(camera, {160, 120}).pixels_read();
  EXPECT_LE(std::count(read.begin(), read.end(), 1), 4 * 160 * 120);
}

TEST(ImagePreparation, APreparedImageIsUsedAsItIs) {
  for (const ImageSize size : {ImageSize{160, 120}, {7, 5}, {375, 240}, {752, 480}}) {
    const ImagePreparation first(euroc_cam0(), size);
    const CameraModel camera = first.prepared_camera();
    const ImagePreparation second(camera, size);
    const cv::Mat image = random_image(camera, 3);
    const std::vector<std::uint8_t> pixels = second.apply(image);
    EXPECT_TRUE(std::equal(pixels.begin(), pixels.end(), image.begin<uchar>(), image.end<uchar>()));
    EXPECT_EQ(second.intrinsics().fx, first.intrinsics().fx);
    EXPECT_EQ(second.intrinsics().fy, first.intrinsics().fy);
    EXPECT_EQ(second.intrinsics().cx, first.intrinsics().cx);
    EXPECT_EQ(second.intrinsics().cy, first.intrinsics().cy);
    EXPECT_EQ(camera.T_body_camera.matrix(), euroc_cam0().T_body_camera.matrix());
  }
}

TEST(ImagePreparation, APreparedImageHasOneSize) {
  const CameraModel camera = ImagePreparation(euroc_cam0(), {160, 120}).prepared_camera();
  for (const ImageSize other : {ImageSize{80, 60}, {160, 119}, {320, 240}})
    testing::expect_input_error([&] { ImagePreparation(camera, other); },
                                {"already undistorted and decimated to 160x120",
                                 fmt::format("{}x{}", other.width, other.height)});
}

}  // namespace
}  // namespace leviosim::traces
