// The kernels that the host computes in a way of its own give what the counted ones give, whose
// values nothing else looks at in a release build (workload/math/host_value.h).
#include "workload/vision/host_kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/workload/vision/test_images.h"
#include "workload/levio/vision/corner_tests.h"
#include "workload/levio/vision/levio_descriptor.h"
#include "workload/levio/vision/offset_tables.h"
#include "workload/vision/hamming.h"
#include "workload/vision/harris.h"

namespace leviosim::vio::vision_test {
namespace {

using C = work::Counting;
constexpr int kPictureWidth = 61, kPictureHeight = 53;

std::vector<cv::Mat> pictures() {
  std::vector<cv::Mat> images = {noise_image(kPictureWidth, kPictureHeight, 1),
                                 rectangle_image(kPictureWidth, kPictureHeight, 2),
                                 cv::Mat(kPictureHeight, kPictureWidth, CV_8U, cv::Scalar(255)),
                                 cv::Mat(kPictureHeight, kPictureWidth, CV_8U, cv::Scalar(0))};
  cv::Mat extremes = noise_image(kPictureWidth, kPictureHeight, 3);
  cv::threshold(extremes, extremes, 127, 255, cv::THRESH_BINARY);
  images.push_back(extremes);
  return images;
}

/// Calls visit(image, index of a pixel) for all that are `reach` away from the border.
template <class Visit>
void for_pixels(int reach, Visit&& visit) {
  for (const cv::Mat& picture : pictures()) {
    PolicyImage<C> copy(picture);
    const ConstImageView<C> image = copy.view();
    for (int y = reach; y < kPictureHeight - reach; ++y)
      for (int x = reach; x < kPictureWidth - reach; ++x) visit(image, y * kPictureWidth + x);
  }
}

TEST(VisionHost, WhatIsCountedIsTheWayOfTheTarget) {
  const auto slow_sum = [](work::I32 n) {
    work::I32 sum = 0;
    for (int i : C::range(0, work::value(n))) sum += work::I32(i);
    return sum;
  };
  work::take_tally();
  const work::I32 expected = slow_sum(10);
  const work::Counts counts = work::take_tally();
  const work::I32 sum = host_value([&] { return slow_sum(10); }, [] { return work::I32(45); });
  EXPECT_EQ(work::value(sum), work::value(expected));
  EXPECT_EQ(work::take_tally(), counts);
  EXPECT_EQ(counts[work::Op::IntAlu], 10u);
}

TEST(VisionHost, ARunOfNineOnTheRingIsAnArcWhereverItBegins) {
  for (std::uint32_t bits = 0; bits < 1u << kRingSize; ++bits) {
    int run = 0, longest = 0;
    for (int k = 0; k < 2 * kRingSize; ++k) {
      run = bits >> k % kRingSize & 1 ? run + 1 : 0;
      longest = std::max(longest, run);
    }
    ASSERT_EQ(host::has_arc(bits), longest >= kFastArc) << bits;
  }
}

TEST(VisionHost, CornersAreThoseOfBothCountedTests) {
  work::Arena memory("L1", Bytes(4096));
  const levio::OffsetTables<C> tables(memory, kPictureWidth);
  std::vector<work::I32> ring(kRingSize);
  fill_ring_offsets<C>(kPictureWidth, span_of<C>(ring));
  int corners = 0, others = 0;
  for (const int threshold : {0, 10, 60, 254})
    for_pixels(kRingRadius, [&](ConstImageView<C> image, int centre) {
      const bool corner = host::is_corner(image.pixels.data() + centre, kPictureWidth, threshold);
      ASSERT_EQ(corner,
                work::value(is_fast_corner<C>(image.pixels, centre, span_of<C>(ring), threshold)));
      ASSERT_EQ(corner, work::value(levio::is_corner<C>(image.pixels, centre, tables, threshold)));
      ++(corner ? corners : others);
    });
  EXPECT_GT(corners, 1000);
  EXPECT_GT(others, 1000);
}

TEST(VisionHost, TheHarrisResponseIsThatOfBothCountedKernels) {
  work::Arena memory("L1", Bytes(4096));
  const levio::OffsetTables<C> tables(memory, kPictureWidth);
  for_pixels(kHarrisReach + 1, [&](ConstImageView<C> image, int centre) {
    const int response = host::harris_response(image.pixels.data() + centre, kPictureWidth);
    ASSERT_EQ(response,
              work::value(harris_response<C>(image.pixels, kPictureWidth, centre % kPictureWidth,
                                             centre / kPictureWidth)));
    ASSERT_EQ(response,
              work::value(levio::corner_response<C>(image.pixels, kPictureWidth, centre, tables)));
  });
}

TEST(VisionHost, MomentsAreThoseOfBothCountedDiscs) {
  std::vector<work::I32> half_widths = local_copy<C>(kDiscHalfWidths<C>);
  constexpr host::DiscMask kDisc = host::make_disc_mask(kDiscRadius * kDiscRadius + 1);
  constexpr host::DiscMask kReleased = host::make_disc_mask(levio::kSquaredDiscRadius);
  for_pixels(kDescriptorReach, [&](ConstImageView<C> image, int centre) {
    const auto* pixel = image.pixels.data() + centre;
    const Moments<C> counted =
        disc_moments<C>(image.pixels, kPictureWidth, centre, span_of<C>(half_widths));
    const Moments<work::Native> plain = host::disc_moments(kDisc, pixel, kPictureWidth);
    ASSERT_EQ(plain.m10, work::value(counted.m10));
    ASSERT_EQ(plain.m01, work::value(counted.m01));
    const Moments<C> counted_released = levio::disc_moments<C>(image.pixels, kPictureWidth, centre);
    const Moments<work::Native> released = host::disc_moments(kReleased, pixel, kPictureWidth);
    ASSERT_EQ(released.m10, work::value(counted_released.m10));
    ASSERT_EQ(released.m01, work::value(counted_released.m01));
  });
}

/// In steps of 15° around the circle.
template <class Points>
void expect_the_counted_pairs(const std::array<work::U32, kPairs>& words) {
  const C::Span<const work::U32> pattern(words.data(), kPairs);
  int step = 0;
  for_pixels(kDescriptorReach, [&](ConstImageView<C> image, int centre) {
    const double angle = 0.2618 * step++;
    const Direction<work::Native> plain{static_cast<int>(256 * std::cos(angle)),
                                        static_cast<int>(256 * std::sin(angle))};
    const int word = step % kDescriptorWords;
    const work::U32 counted = compare_pairs<C, Points>(
        image.pixels, kPictureWidth, centre, Direction<C>{plain.cos, plain.sin}, pattern, word);
    ASSERT_EQ(compare_pairs_on_host<Points>(image.pixels.data() + centre, kPictureWidth, plain,
                                            words.data() + kWordBits * word),
              work::value(counted));
  });
}

TEST(VisionHost, DescriptorsAreTheCountedOnesOfAllPatterns) {
  expect_the_counted_pairs<RotatedPoints>(kPairPattern<C>);
  expect_the_counted_pairs<levio::ExactDescriptor>(levio::ExactDescriptor::pattern<C>());
  expect_the_counted_pairs<levio::ReleasedDescriptor>(levio::ReleasedDescriptor::pattern<C>());
}

TEST(VisionHost, DistancesAreTheNumbersOfBitsThatDiffer) {
  Random random(5);
  std::vector<work::U32> words(2 * kDescriptorWords);
  for (int run = 0; run < 1000; ++run) {
    int expected = 0;
    for (int w = 0; w < kDescriptorWords; ++w) {
      const std::uint32_t differing = random.bits() & random.bits();
      words[w] = random.bits();
      words[kDescriptorWords + w] = words[w].v ^ differing;
      expected += work::popcount(static_cast<std::uint32_t>(differing));
    }
    const DescriptorWords<C> both{words.data(), 2 * kDescriptorWords};
    ASSERT_EQ(work::value(hamming_distance_on_host(hold_descriptor<C>(both, work::I32(0)),
                                                   words.data() + kDescriptorWords)),
              expected);
  }
}

}  // namespace
}  // namespace leviosim::vio::vision_test
