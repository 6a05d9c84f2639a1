// The pair pattern's properties; descriptors against plain loops, under rotation, and their bits on
// images.
#include "workload/vision/descriptor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/support/pair_learner.h"
#include "tests/workload/vision/runs.h"

namespace leviosim::vio::vision_test {
namespace {

std::vector<PointPair> unpacked_pattern() {
  std::vector<PointPair> pairs;
  for (const std::uint32_t word : kPairWords) pairs.push_back(tests::unpack_pair(word));
  return pairs;
}

TEST(VisionPairPattern, StaysInTheDiscAndIsWellSpread) {
  double sum_x = 0, sum_y = 0, squares = 0;
  std::vector<int> quadrants(4);
  for (const PointPair& p : unpacked_pattern()) {
    EXPECT_LE(p.x1 * p.x1 + p.y1 * p.y1, 225);
    EXPECT_LE(p.x2 * p.x2 + p.y2 * p.y2, 225);
    EXPECT_GE(std::hypot(p.x2 - p.x1, p.y2 - p.y1), kMinPairDistance);
    EXPECT_LE(std::abs(p.x2 - p.x1), std::abs(p.y2 - p.y1));
    for (const auto& [x, y] : {std::pair(p.x1, p.y1), std::pair(p.x2, p.y2)}) {
      sum_x += x;
      sum_y += y;
      squares += x * x + y * y;
      ++quadrants[(x > 0 ? 1 : 0) + (y > 0 ? 2 : 0)];
    }
  }
  // The standard error of a mean of 512 coordinates of deviation 6 is 0.27.
  EXPECT_NEAR(sum_x / 512, 0, 1.1);
  EXPECT_NEAR(sum_y / 512, 0, 1.1);
  EXPECT_NEAR(std::sqrt(squares / 1024), 6.2, 0.6);
  for (const int n : quadrants) EXPECT_NEAR(n, 128, 45);
}

TEST(VisionPairPattern, HasNoPairTwice) {
  std::vector<std::array<int, 4>> pairs;
  for (const PointPair& p : unpacked_pattern()) {
    pairs.push_back({p.x1, p.y1, p.x2, p.y2});
    pairs.push_back({p.x2, p.y2, p.x1, p.y1});
  }
  std::sort(pairs.begin(), pairs.end());
  EXPECT_EQ(std::adjacent_find(pairs.begin(), pairs.end()), pairs.end());
}

/// The descriptor of the pixel (x, y) of an image that counts as blurred already.
template <class P>
std::array<std::uint32_t, kDescriptorWords> descriptor_at(const cv::Mat& image, int x, int y,
                                                          int cos, int sin) {
  PolicyImage<P> copy(image);
  std::vector<typename P::U32> words(kDescriptorWords);
  const typename P::template L2Span<const typename P::U32> pattern(kPairPattern<P>.data(), kPairs);
  describe<P, RotatedPoints>(copy.view().pixels, image.cols, y * image.cols + x,
                             Direction<P>{cos, sin}, pattern, span_of<P>(words));
  std::array<std::uint32_t, kDescriptorWords> plain;
  for (int w = 0; w < kDescriptorWords; ++w) plain[w] = work::value(words[w]);
  return plain;
}

std::array<std::uint32_t, kDescriptorWords> reference_descriptor(const cv::Mat& image, int x, int y,
                                                                 int cos, int sin) {
  const auto level = [&](int dx, int dy) {
    const double u = std::floor((cos * dx - sin * dy) / 256.0 + 0.5);
    const double v = std::floor((sin * dx + cos * dy) / 256.0 + 0.5);
    return image.at<std::uint8_t>(y + static_cast<int>(std::clamp(v, -15.0, 15.0)),
                                  x + static_cast<int>(std::clamp(u, -15.0, 15.0)));
  };
  std::array<std::uint32_t, kDescriptorWords> words{};
  const std::vector<PointPair> pattern = unpacked_pattern();
  for (int k = 0; k < kPairs; ++k) {
    const PointPair& p = pattern[k];
    if (level(p.x1, p.y1) < level(p.x2, p.y2)) words[k / 32] |= 1u << (31 - k % 32);
  }
  return words;
}

TEST(VisionDescriptor, AgreesWithPlainLoops) {
  const cv::Mat image = noise_image(31, 31, 12);
  for (int degrees = 0; degrees < 360; degrees += 7) {
    const int cos = static_cast<int>(256 * std::cos(degrees * CV_PI / 180));
    const int sin = static_cast<int>(256 * std::sin(degrees * CV_PI / 180));
    const auto expected = reference_descriptor(image, 15, 15, cos, sin);
    EXPECT_EQ(descriptor_at<work::Native>(image, 15, 15, cos, sin), expected) << degrees;
    EXPECT_EQ(descriptor_at<work::Counting>(image, 15, 15, cos, sin), expected) << degrees;
  }
}

TEST(VisionDescriptor, ComparesWithoutBranches) {
  const cv::Mat image = noise_image(31, 31, 13);
  work::take_tally();
  descriptor_at<work::Counting>(image, 15, 15, 256, 0);
  const work::Counts counts = work::take_tally();
  EXPECT_EQ(counts[work::Op::LoadIndexed], 512u);
  EXPECT_EQ(counts[work::Op::LoadL2], 256u);
  EXPECT_EQ(counts[work::Op::BranchTaken] + counts[work::Op::BranchNotTaken], 0u);
}

/// Features of both images at corresponding places.
struct Pairing {
  int pairs = 0;
  double mean_distance = 0;
};
template <class Place>
Pairing pair_up(const Features& before, const Features& after, Place&& place) {
  Pairing result;
  for (const Feature& a : before)
    for (const Feature& b : after) {
      const auto [x, y] = place(a.x, a.y);
      if (std::abs(x - b.x) > 0.8 || std::abs(y - b.y) > 0.8) continue;
      ++result.pairs;
      result.mean_distance += distance_between(a, b);
    }
  result.mean_distance /= result.pairs;
  return result;
}

TEST(VisionDescriptor, FollowsAQuarterTurnOfTheImage) {
  const int side = 128;
  const cv::Mat image = rectangle_image(side, side, 14);
  // With one cell for everything the choice of corners does not depend on the turn of the grid.
  ExtractorOptions options;
  options.cell = side;
  options.per_cell = 16;
  cv::Mat turned = image;
  for (int turns = 1; turns <= 3; ++turns) {
    turned = quarter_turn(turned);
    const auto place = [&](double x, double y) {
      for (int i = 0; i < turns; ++i) {
        const double old_x = x;
        x = side - 1 - y;
        y = old_x;
      }
      return std::pair(x, y);
    };
    const Pairing pairing = pair_up(extract<work::Native>(image, 1, options),
                                    extract<work::Native>(turned, 1, options), place);
    EXPECT_EQ(pairing.pairs, 16);
    EXPECT_LT(pairing.mean_distance, 6) << turns << " quarter turns";
  }
}

TEST(VisionDescriptor, FollowsAnArbitraryTurnOfTheImage) {
  const int side = 160;
  cv::Mat image = rectangle_image(side, side, 15);
  cv::GaussianBlur(image, image, cv::Size(), 1.2);
  for (const double degrees : {20.0, 45.0, 110.0}) {
    const cv::Mat turn = cv::getRotationMatrix2D(cv::Point2f(79.5f, 79.5f), degrees, 1);
    cv::Mat turned;
    cv::warpAffine(image, turned, turn, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
    const auto at = [&](int r, int c) { return turn.at<double>(r, c); };
    const Pairing pairing = pair_up(extract<work::Native>(image, 1),
                                    extract<work::Native>(turned, 1), [&](int x, int y) {
                                      return std::pair(at(0, 0) * x + at(0, 1) * y + at(0, 2),
                                                       at(1, 0) * x + at(1, 1) * y + at(1, 2));
                                    });
    EXPECT_GT(pairing.pairs, 30);
    // Unrelated descriptors differ in about 128 bits.
    EXPECT_LT(pairing.mean_distance, 45) << degrees << " degrees";
  }
}

void expect_balanced_bits(const std::vector<cv::Mat>& images) {
  std::vector<double> ones(kPairs);
  double features = 0;
  for (const cv::Mat& image : images)
    for (const Feature& f : extract<work::Native>(image)) {
      ++features;
      for (int k = 0; k < kPairs; ++k) ones[k] += f.words[k / 32] >> (31 - k % 32) & 1u;
    }
  ASSERT_GT(features, 500);
  double squared_bias = 0;
  for (const double n : ones) {
    EXPECT_GT(n / features, 0.15);
    EXPECT_LT(n / features, 0.85);
    squared_bias += (n / features - 0.5) * (n / features - 0.5);
  }
  EXPECT_LT(std::sqrt(squared_bias / kPairs), 0.18);
}

TEST(VisionDescriptor, BitsAreBalancedOnRectangles) {
  std::vector<cv::Mat> images;
  for (std::uint64_t seed = 20; seed < 26; ++seed)
    images.push_back(rectangle_image(160, 120, seed));
  expect_balanced_bits(images);
}

TEST(VisionDescriptor, BitsAreBalancedOnRecordedFrames) {
  const std::vector<cv::Mat> frames = recorded_frames(0, 300, 40);
  if (frames.empty()) GTEST_SKIP() << kNoRecordedData;
  expect_balanced_bits(frames);
}

}  // namespace
}  // namespace leviosim::vio::vision_test
