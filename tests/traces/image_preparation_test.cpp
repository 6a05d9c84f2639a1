// Prepared images: which pixels they come from, and that they need no second preparation. What the
// pixels must be is held by image_source_test.cpp.
#include "traces/datasets/image_preparation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/traces/test_folder.h"
#include "traces/datasets/euroc_sensors.h"
#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

using Pixels = std::vector<std::uint8_t>;

Pixels random_image(const CameraModel& camera, std::uint64_t seed) {
  Rng rng(seed);
  Pixels image(static_cast<std::size_t>(camera.height) * camera.width);
  for (std::uint8_t& pixel : image) pixel = static_cast<std::uint8_t>(rng.below(256));
  return image;
}

TEST(ImagePreparation, ReadsNoPixelButThoseItNames) {
  const CameraModel camera = euroc_cam0();
  for (const ImageSize size : {ImageSize{160, 120}, {320, 240}, {752, 480}}) {
    const ImagePreparation preparation(camera, size);
    const Pixels image = random_image(camera, 1);
    Pixels spoiled = random_image(camera, 2);
    const Pixels read = preparation.pixels_read();
    for (std::size_t i = 0; i < read.size(); ++i)
      if (read[i] != 0) spoiled[i] = image[i];
    EXPECT_EQ(preparation.apply(image), preparation.apply(spoiled)) << size.width;
  }
  const Pixels read = ImagePreparation(camera, {160, 120}).pixels_read();
  EXPECT_LE(std::count(read.begin(), read.end(), 1), 4 * 160 * 120);
}

/// Positions left of and above the image, far outside, and between its last pixels; the lens is our
/// own model of it.
TEST(ImagePreparation, PixelsAreWhereTheCameraModelSays) {
  for (const double k1 : {-0.45, 0.3, 5.0, 1000.0}) {
    CameraModel camera = euroc_cam0();
    camera.k1 = k1;
    if (k1 == 0.3) camera.lens = Lens::equidistant;
    const Pixels image = random_image(camera, 4);
    cv::Mat u(camera.height, camera.width, CV_32F);
    cv::Mat v = u.clone();
    for (int y = 0; y < u.rows; ++y)
      for (int x = 0; x < u.cols; ++x) {
        const Eigen::Vector2d at =
            camera.distort({(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy});
        u.at<float>(y, x) =
            static_cast<float>(std::rint((camera.fx * at.x() + camera.cx) * 32) / 32);
        v.at<float>(y, x) =
            static_cast<float>(std::rint((camera.fy * at.y() + camera.cy) * 32) / 32);
      }
    cv::Mat expected;
    const cv::Mat given(camera.height, camera.width, CV_8UC1,
                        const_cast<std::uint8_t*>(image.data()));
    cv::remap(given, expected, u, v, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    const Pixels got = ImagePreparation(camera, {camera.width, camera.height}).apply(image);
    EXPECT_TRUE(std::equal(got.begin(), got.end(), expected.begin<uchar>())) << k1;
  }
}

TEST(ImagePreparation, TakesTheWidestAndTheTallestImage) {
  for (const ImageSize size : {ImageSize{32766, 2}, {2, 32766}}) {
    CameraModel camera;
    camera.fx = camera.fy = 100;
    camera.width = size.width;
    camera.height = size.height;
    const Pixels image = random_image(camera, 5);
    EXPECT_EQ(ImagePreparation(camera, size).apply(image), image);
    (size.width > size.height ? camera.width : camera.height) += 1;
    testing::expect_input_error([&] { ImagePreparation(camera, {1, 1}); }, {"32766 pixels"});
  }
}

TEST(ImagePreparation, APreparedImageIsUsedAsItIs) {
  for (const ImageSize size : {ImageSize{160, 120}, {7, 5}, {375, 240}, {752, 480}}) {
    const ImagePreparation first(euroc_cam0(), size);
    const CameraModel camera = first.prepared_camera();
    const ImagePreparation second(camera, size);
    const Pixels image = random_image(camera, 3);
    EXPECT_EQ(second.apply(image), image);
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
