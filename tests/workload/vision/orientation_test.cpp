// Intensity centroid against double precision over an explicit disc.
#include "workload/vision/orientation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/workload/vision/test_images.h"

namespace leviosim::vio::vision_test {
namespace {

template <class P>
Moments<P> moments_at(const cv::Mat& image, int x, int y) {
  PolicyImage<P> copy(image);
  auto half_widths = local_copy<P>(kDiscHalfWidths<P>);
  return disc_moments<P>(copy.view().pixels, image.cols, y * image.cols + x,
                         span_of<P>(half_widths));
}

struct Centroid {
  double m10 = 0, m01 = 0;
};
Centroid reference_moments(const cv::Mat& image, int x, int y) {
  Centroid m;
  for (int dy = -15; dy <= 15; ++dy)
    for (int dx = -15; dx <= 15; ++dx)
      if (dx * dx + dy * dy <= 15 * 15) {
        m.m10 += dx * static_cast<double>(image.at<std::uint8_t>(y + dy, x + dx));
        m.m01 += dy * static_cast<double>(image.at<std::uint8_t>(y + dy, x + dx));
      }
  return m;
}

TEST(VisionOrientation, MomentsAndDirectionAgreeWithDoublePrecision) {
  const cv::Mat image = rectangle_image(60, 50, 10);
  for (int y = 15; y < 35; ++y)
    for (int x = 15; x < 45; ++x) {
      const Centroid expected = reference_moments(image, x, y);
      const Moments<work::Native> m = moments_at<work::Native>(image, x, y);
      ASSERT_EQ(m.m10, expected.m10);
      ASSERT_EQ(m.m01, expected.m01);
      const double angle = std::atan2(expected.m01, expected.m10);
      const Direction<work::Native> d = direction_of<work::Native>(m);
      // Truncation towards zero loses less than one unit.
      ASSERT_NEAR(d.cos, 256 * std::cos(angle), 1.001) << x << ", " << y;
      ASSERT_NEAR(d.sin, 256 * std::sin(angle), 1.001) << x << ", " << y;
      ASSERT_LE(std::abs(d.cos), 256 * std::abs(std::cos(angle)) + 0.001);
      ASSERT_LE(std::abs(d.sin), 256 * std::abs(std::sin(angle)) + 0.001);
    }
}

TEST(VisionOrientation, PoliciesAgree) {
  const cv::Mat image = noise_image(60, 50, 11);
  for (int y = 15; y < 35; y += 3)
    for (int x = 15; x < 45; x += 2) {
      const auto native = moments_at<work::Native>(image, x, y);
      const auto counting = moments_at<work::Counting>(image, x, y);
      ASSERT_EQ(work::value(counting.m10), native.m10);
      ASSERT_EQ(work::value(counting.m01), native.m01);
      ASSERT_EQ(work::value(direction_of<work::Counting>(counting).cos),
                direction_of<work::Native>(native).cos);
      ASSERT_EQ(work::value(direction_of<work::Counting>(counting).sin),
                direction_of<work::Native>(native).sin);
    }
}

TEST(VisionOrientation, AFlatDiscPointsAlongX) {
  const cv::Mat image(31, 31, CV_8U, cv::Scalar(77));
  const auto m = moments_at<work::Native>(image, 15, 15);
  EXPECT_EQ(m.m10, 0);
  EXPECT_EQ(m.m01, 0);
  EXPECT_EQ(direction_of<work::Native>(m).cos, 256);
  EXPECT_EQ(direction_of<work::Native>(m).sin, 0);
}

TEST(VisionOrientation, PointsToTheBrightSide) {
  cv::Mat below(31, 31, CV_8U, cv::Scalar(10));
  below(cv::Rect(0, 20, 31, 11)) = cv::Scalar(200);
  const auto d = direction_of<work::Native>(moments_at<work::Native>(below, 15, 15));
  EXPECT_EQ(d.sin, 256);
  EXPECT_LE(std::abs(d.cos), 1);
}

}  // namespace
}  // namespace leviosim::vio::vision_test
