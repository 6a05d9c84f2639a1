// Binomial blur against OpenCV's filter in floating point, whose sums are exact here.
#include "workload/vision/blur.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/workload/vision/test_images.h"

namespace leviosim::vio::vision_test {
namespace {

/// Blurs in several shares of rows, as cores do.
template <class P>
cv::Mat blurred(const cv::Mat& image, int shares) {
  PolicyImage<P> from(image);
  PolicyImage<P> to(image.cols, image.rows);
  auto kernel = local_copy<P>(kBlurKernel<P>);
  for (int i = 0; i < shares; ++i)
    blur_rows<P>(from.view(), to.view(), image.rows * i / shares, image.rows * (i + 1) / shares,
                 span_of<P>(kernel));
  cv::Mat result(image.size(), CV_8U);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      result.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(to.at(x, y));
  return result;
}

cv::Mat reference_blur(const cv::Mat& image) {
  const cv::Mat binomial = (cv::Mat_<float>(5, 1) << 1, 4, 6, 4, 1);
  const cv::Mat kernel = binomial * binomial.t();
  cv::Mat sums;
  cv::filter2D(image, sums, CV_32F, kernel, cv::Point(-1, -1), 0, cv::BORDER_REPLICATE);
  cv::Mat result(image.size(), CV_8U);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      result.at<std::uint8_t>(y, x) =
          static_cast<std::uint8_t>(std::floor(sums.at<float>(y, x) / 256));
  return result;
}

bool same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0; }

TEST(VisionBlur, AgreesWithOpenCvUpToTheBorder) {
  for (const cv::Size size : {cv::Size(160, 120), cv::Size(97, 75), cv::Size(5, 5)}) {
    const cv::Mat image = noise_image(size.width, size.height, 6);
    const cv::Mat expected = reference_blur(image);
    EXPECT_TRUE(same(blurred<work::Native>(image, 1), expected)) << size;
    EXPECT_TRUE(same(blurred<work::Counting>(image, 1), expected)) << size;
  }
}

TEST(VisionBlur, WorksOnImagesSmallerThanTheKernel) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 4), cv::Size(4, 9), cv::Size(9, 2)}) {
    const cv::Mat image = noise_image(size.width, size.height, 7);
    EXPECT_TRUE(same(blurred<work::Native>(image, 1), reference_blur(image))) << size;
  }
}

TEST(VisionBlur, DoesNotDependOnTheShares) {
  const cv::Mat image = noise_image(97, 75, 8);
  const cv::Mat whole = blurred<work::Native>(image, 1);
  EXPECT_TRUE(same(blurred<work::Native>(image, 3), whole));
  EXPECT_TRUE(same(blurred<work::Native>(image, 8), whole));
}

TEST(VisionBlur, KeepsAConstantImage) {
  const cv::Mat image(20, 30, CV_8U, cv::Scalar(255));
  EXPECT_TRUE(same(blurred<work::Native>(image, 1), image));
}

TEST(VisionBlur, TakesTwentyFiveTapsPerPixel) {
  const cv::Mat image = noise_image(160, 120, 9);
  work::take_tally();
  blurred<work::Counting>(image, 1);
  const work::Counts counts = work::take_tally();
  EXPECT_EQ(counts[work::Op::IntMac], 160u * 120u * 25u);
  EXPECT_EQ(counts[work::Op::StoreStream], 160u * 120u);
}

}  // namespace
}  // namespace leviosim::vio::vision_test
