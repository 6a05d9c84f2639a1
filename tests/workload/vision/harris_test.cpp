// Harris response against plain loops in 64-bit integers, and its properties on drawn images.
#include "workload/vision/harris.h"

#include <gtest/gtest.h>

#include "tests/workload/vision/test_images.h"

namespace leviosim::vio::vision_test {
namespace {

std::int64_t reference_response(const cv::Mat& image, int x, int y) {
  constexpr int kSobel[3][3] = {{-1, 0, 1}, {-2, 0, 2}, {-1, 0, 1}};
  std::int64_t a = 0, b = 0, c = 0;
  for (int v = y - 3; v <= y + 3; ++v)
    for (int u = x - 3; u <= x + 3; ++u) {
      std::int64_t gx = 0, gy = 0;
      for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j) {
          const int level = image.at<std::uint8_t>(v + i, u + j);
          gx += kSobel[i + 1][j + 1] * level;
          gy += kSobel[j + 1][i + 1] * level;
        }
      a += gx * gx;
      b += gy * gy;
      c += gx * gy;
    }
  a >>= 11;
  b >>= 11;
  c >>= 11;
  return a * b - c * c - (a + b) * (a + b) / 25;
}

template <class P>
std::int64_t response(const cv::Mat& image, int x, int y) {
  PolicyImage<P> copy(image);
  return work::value(harris_response<P>(copy.view().pixels, image.cols, x, y));
}

void expect_reference_everywhere(const cv::Mat& image) {
  for (int y = kHarrisReach; y < image.rows - kHarrisReach; ++y)
    for (int x = kHarrisReach; x < image.cols - kHarrisReach; ++x) {
      const std::int64_t expected = reference_response(image, x, y);
      ASSERT_EQ(response<work::Native>(image, x, y), expected) << x << ", " << y;
      ASSERT_EQ(response<work::Counting>(image, x, y), expected) << x << ", " << y;
    }
}

TEST(VisionHarris, AgreesWithPlainLoops) {
  expect_reference_everywhere(noise_image(40, 33, 3));
  expect_reference_everywhere(rectangle_image(47, 39, 4));
}

TEST(VisionHarris, StrongestGradientsDoNotOverflow) {
  // Diagonal stairs of black and white hold the largest sums of squared gradients.
  for (int period = 2; period <= 12; ++period) {
    cv::Mat image(24, 24, CV_8U);
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x)
        image.at<std::uint8_t>(y, x) = (x / period + y / period) % 2 == 0 ? 255 : 0;
    expect_reference_everywhere(image);
  }
}

TEST(VisionHarris, TellsCornersFromEdgesAndFlatAreas) {
  cv::Mat corner(21, 21, CV_8U, cv::Scalar(50));
  corner(cv::Rect(10, 10, 11, 11)) = cv::Scalar(200);
  cv::Mat edge(21, 21, CV_8U, cv::Scalar(50));
  edge(cv::Rect(10, 0, 11, 21)) = cv::Scalar(200);
  const cv::Mat flat(21, 21, CV_8U, cv::Scalar(90));
  EXPECT_GT(response<work::Native>(corner, 10, 10), 100000);
  EXPECT_LT(response<work::Native>(edge, 10, 10), 0);
  EXPECT_EQ(response<work::Native>(flat, 10, 10), 0);
}

TEST(VisionHarris, DoesNotChangeWhenRowsAndColumnsAreExchanged) {
  const cv::Mat image = noise_image(31, 31, 5);
  for (int y = 5; y < 26; ++y)
    for (int x = 5; x < 26; ++x)
      ASSERT_EQ(response<work::Native>(image, x, y), response<work::Native>(image.t(), y, x));
}

}  // namespace
}  // namespace leviosim::vio::vision_test
