// FAST-9: the same corners as OpenCV's, and one property at a time on a drawn ring.
#include "workload/vision/fast.h"

#include <gtest/gtest.h>

#include <opencv2/features2d.hpp>
#include <set>
#include <utility>

#include "tests/workload/vision/test_images.h"

namespace leviosim::vio::vision_test {
namespace {

using Pixels = std::set<std::pair<int, int>>;

template <class P>
Pixels corners_of(const cv::Mat& image, int threshold) {
  PolicyImage<P> copy(image);
  std::vector<typename P::I32> offsets(kRingSize);
  fill_ring_offsets<P>(image.cols, span_of<P>(offsets));
  Pixels corners;
  for (int y = kRingRadius; y < image.rows - kRingRadius; ++y)
    for (int x = kRingRadius; x < image.cols - kRingRadius; ++x)
      if (is_fast_corner<P>(copy.view().pixels, y * image.cols + x, span_of<P>(offsets), threshold))
        corners.insert({x, y});
  return corners;
}

Pixels opencv_corners_of(const cv::Mat& image, int threshold) {
  std::vector<cv::KeyPoint> keypoints;
  cv::FAST(image, keypoints, threshold, false, cv::FastFeatureDetector::TYPE_9_16);
  Pixels corners;
  for (const cv::KeyPoint& k : keypoints)
    corners.insert({static_cast<int>(k.pt.x), static_cast<int>(k.pt.y)});
  return corners;
}

void expect_same_corners_as_opencv(const cv::Mat& image) {
  for (const int threshold : {5, 20, 60}) {
    const Pixels expected = opencv_corners_of(image, threshold);
    EXPECT_EQ(corners_of<work::Native>(image, threshold), expected) << "threshold " << threshold;
    EXPECT_EQ(corners_of<work::Counting>(image, threshold), expected) << "threshold " << threshold;
  }
}

TEST(VisionFast, FindsTheCornersOfOpenCvInNoise) {
  const cv::Mat image = noise_image(97, 75, 1);
  ASSERT_GT(opencv_corners_of(image, 20).size(), 100u);
  expect_same_corners_as_opencv(image);
}

TEST(VisionFast, FindsTheCornersOfOpenCvAmongRectangles) {
  const cv::Mat image = rectangle_image(160, 120, 2);
  ASSERT_GT(opencv_corners_of(image, 20).size(), 100u);
  expect_same_corners_as_opencv(image);
}

TEST(VisionFast, FindsTheCornersOfOpenCvInARecordedFrame) {
  const std::vector<cv::Mat> frames = recorded_frames(100, 101, 1);
  if (frames.empty()) GTEST_SKIP() << kNoRecordedData;
  expect_same_corners_as_opencv(frames.front());
}

/// A 7×7 image of level 100 in whose ring `length` pixels from `start` on have another level.
cv::Mat ring_image(int start, int length, int level) {
  cv::Mat image(7, 7, CV_8U, cv::Scalar(100));
  for (int k = start; k < start + length; ++k) {
    const RingPoint p = kRing[k % kRingSize];
    image.at<std::uint8_t>(3 + p.dy, 3 + p.dx) = static_cast<std::uint8_t>(level);
  }
  return image;
}

TEST(VisionFast, NineNeighboursMakeACornerWhereverTheyStart) {
  for (int start = 0; start < kRingSize; ++start)
    for (const int level : {79, 121}) {
      EXPECT_EQ(corners_of<work::Native>(ring_image(start, 9, level), 20).size(), 1u) << start;
      EXPECT_EQ(corners_of<work::Native>(ring_image(start, 8, level), 20).size(), 0u) << start;
    }
}

TEST(VisionFast, TheThresholdMustBeExceeded) {
  EXPECT_EQ(corners_of<work::Native>(ring_image(0, 16, 120), 20).size(), 0u);
  EXPECT_EQ(corners_of<work::Native>(ring_image(0, 16, 80), 20).size(), 0u);
  EXPECT_EQ(corners_of<work::Native>(ring_image(0, 16, 80), 19).size(), 1u);
}

TEST(VisionFast, BrighterAndDarkerNeighboursDoNotAddUp) {
  cv::Mat image = ring_image(0, 8, 200);
  const cv::Mat darker = ring_image(8, 8, 0);
  for (int k = 8; k < kRingSize; ++k) {
    const RingPoint p = kRing[k];
    image.at<std::uint8_t>(3 + p.dy, 3 + p.dx) = darker.at<std::uint8_t>(3 + p.dy, 3 + p.dx);
  }
  EXPECT_EQ(corners_of<work::Native>(image, 20).size(), 0u);
}

TEST(VisionFast, EveryPixelCostsTheSame) {
  const auto cost_of = [](const cv::Mat& image) {
    PolicyImage<work::Counting> copy(image);
    std::vector<work::I32> offsets(kRingSize);
    fill_ring_offsets<work::Counting>(image.cols, span_of<work::Counting>(offsets));
    work::take_tally();
    const work::Cond corner = is_fast_corner<work::Counting>(copy.view().pixels, 3 * image.cols + 3,
                                                             span_of<work::Counting>(offsets), 20);
    (void)corner;
    return work::take_tally();
  };
  const work::Counts flat = cost_of(ring_image(0, 0, 0));
  EXPECT_TRUE(flat == cost_of(ring_image(5, 12, 200)));
  EXPECT_EQ(flat[work::Op::LoadIndexed], 16u);
  EXPECT_EQ(flat[work::Op::LoopIteration], 16u + 16u + 8u);
}

}  // namespace
}  // namespace leviosim::vio::vision_test
