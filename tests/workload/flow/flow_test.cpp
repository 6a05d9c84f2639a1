// Optical flow: known displacements, what is rejected, and the same figures as a reference that was
// written without chips in mind.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "sim/work/machine.h"
#include "sim/work/transfers.h"
#include "tests/workload/flow/flow_reference.h"

namespace leviosim::flow::testing {
namespace {

using work::Op;

constexpr int kSide = 64;
constexpr int kPixel = 1 << 8;

TEST(Flow, OfAShiftedImageIsTheShift) {
  const cv::Mat scene = smooth_image(96, 1);
  const cv::Mat before = window(scene, 16, 16, kSide);
  for (int dy = -4; dy <= 4; ++dy)
    for (int dx = -4; dx <= 4; ++dx) {
      const Flow flow = flow_between(false, before, window(scene, 16 - dx, 16 - dy, kSide));
      EXPECT_EQ(figures(flow), (std::array{dx * kPixel, dy * kPixel, 255, 25, 25}))
          << dx << ", " << dy;
    }
}

TEST(Flow, FindsHalfPixelsInAllDirections) {
  const cv::Mat now = smooth_image(kSide, 2);
  for (int hy = -1; hy <= 1; ++hy)
    for (int hx = -1; hx <= 1; ++hx) {
      cv::Mat before = now.clone();
      for (int y = 1; y < kSide - 1; ++y)
        for (int x = 1; x < kSide - 1; ++x) {
          const auto mean = [&](int row) {
            return (now.at<std::uint8_t>(row, x) + now.at<std::uint8_t>(row, x + hx)) / 2;
          };
          before.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>((mean(y) + mean(y + hy)) / 2);
        }
      const Flow flow = flow_between(false, before, now);
      EXPECT_EQ(flow.x, hx * kPixel / 2) << hx << ", " << hy;
      EXPECT_EQ(flow.y, hy * kPixel / 2) << hx << ", " << hy;
    }
}

TEST(Flow, IsNoneWhereThereIsNothingToSee) {
  const cv::Mat flat(kSide, kSide, CV_8U, cv::Scalar(90));
  EXPECT_EQ(figures(flow_between(false, flat, flat)), (std::array{0, 0, 0, 0, 0}));
}

TEST(Flow, IsNoneBetweenImagesOfDifferentThings) {
  const cv::Mat before = vio::vision_test::noise_image(kSide, kSide, 3);
  const cv::Mat now = vio::vision_test::noise_image(kSide, kSide, 4);
  EXPECT_EQ(figures(flow_between(false, before, now)), (std::array{0, 0, 0, 25, 0}));
}

// Brighter by 10 levels everywhere, a block differs by 640.
TEST(Flow, MatchesDifferByLessThanTheLimit) {
  const cv::Mat before = vio::vision_test::noise_image(kSide, kSide, 9) * 0.5;
  const cv::Mat now = before + cv::Scalar(10);
  Options options;
  options.max_difference = 641;
  EXPECT_EQ(flow_between(false, before, now, options).matched, 25);
  options.max_difference = 640;
  EXPECT_EQ(flow_between(false, before, now, options).matched, 0);
}

/// A picture that turns about its centre moves all blocks in other directions: the middle ones by
/// little, the outer ones by more than a pixel. None of it is flow.
TEST(Flow, OfAPictureThatTurnsIsNextToNone) {
  const cv::Mat before = smooth_image(kSide, 5, 4);
  cv::Mat now = before.clone();
  constexpr double kAngle = 0.06;
  constexpr double kCentre = (kSide - 1) / 2.0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double u = x - kCentre, v = y - kCentre;
      const double from_x = std::clamp(kCentre + u + kAngle * v, 0.0, kSide - 1.001);
      const double from_y = std::clamp(kCentre + v - kAngle * u, 0.0, kSide - 1.001);
      const int i = static_cast<int>(from_x), j = static_cast<int>(from_y);
      const double a = from_x - i, b = from_y - j;
      const auto level = [&](int s, int t) { return double{before.at<std::uint8_t>(t, s) * 1.0}; };
      now.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(
          (1 - b) * ((1 - a) * level(i, j) + a * level(i + 1, j)) +
          b * ((1 - a) * level(i, j + 1) + a * level(i + 1, j + 1)) + 0.5);
    }
  const Flow flow = flow_between(false, before, now);
  EXPECT_LT(std::abs(flow.x), kPixel / 2);
  EXPECT_LT(std::abs(flow.y), kPixel / 2);
}

TEST(Flow, FollowsTheMajority) {
  const cv::Mat scene = smooth_image(96, 6);
  const cv::Mat before = window(scene, 16, 16, kSide);
  cv::Mat now = window(scene, 14, 17, kSide);  // by (2, -1)
  // The upper two rows of blocks move by (-3, 3) instead.
  window(scene, 19, 13, kSide)(cv::Rect(0, 0, kSide, 30)).copyTo(now(cv::Rect(0, 0, kSide, 30)));
  const Flow flow = flow_between(false, before, now);
  EXPECT_EQ(flow.x, 2 * kPixel);
  EXPECT_EQ(flow.y, -kPixel);
}

class FlowAgainstReference : public ::testing::TestWithParam<int> {};

/// Random displacements, beyond the search range too, noise, and options.
TEST_P(FlowAgainstReference, IsTheSameUnderBothPoliciesOnOneCoreAndMore) {
  Random random(static_cast<std::uint64_t>(GetParam()));
  Options options;
  options.side = random.between(0, 3) == 0 ? 48 : kSide;
  options.grid = random.between(1, 7);
  options.search = random.between(1, 6);
  options.min_matches = 1;
  options.max_difference = random.between(100, 3000);
  options.min_texture = random.between(0, 200);
  const cv::Mat scene = smooth_image(112, random.bits(), random.between(0, 3));
  const cv::Mat before = window(scene, 24, 24, options.side);
  cv::Mat now = window(scene, 24 + random.between(-5, 5), 24 + random.between(-5, 5), options.side);
  const int noise = random.between(0, 12);
  for (int y = 0; y < now.rows; ++y)
    for (int x = 0; x < now.cols; ++x) {
      auto& level = now.at<std::uint8_t>(y, x);
      level = static_cast<std::uint8_t>(std::clamp(level + random.between(-noise, noise), 0, 255));
    }
  const auto expected = figures(Reference(before, now, options).flow());
  EXPECT_EQ(figures(flow_between(false, before, now, options)), expected);
  EXPECT_EQ(figures(flow_between(true, before, now, options)), expected);
  EXPECT_EQ(figures(flow_between(true, before, now, options, 1)), expected);
  EXPECT_EQ(figures(flow_between(true, before, now, options, 5)), expected);
}

INSTANTIATE_TEST_SUITE_P(Random, FlowAgainstReference, ::testing::Range(1, 25));

TEST(Flow, GyroTakesOffTheRotationOfTheCamera) {
  const cv::Mat scene = smooth_image(96, 7);
  const cv::Mat before = window(scene, 16, 16, kSide);
  const cv::Mat now = window(scene, 14, 17, kSide);  // by (2, -1)
  Options options;
  options.gyro = true;
  options.focal_length = 100;
  // About +y the picture goes left, about +x down: what is left of (2, -1) is (2 + 3, -1 - 0.5).
  for (const bool counting : {false, true}) {
    const Flow flow = flow_between(counting, before, now, options, 8, 0.005f, 0.03f);
    EXPECT_NEAR(flow.x, 5 * kPixel, 1);
    EXPECT_NEAR(flow.y, -3 * kPixel / 2, 1);
  }
}

/// The work follows from the published sizes: 81 candidates of 16 words for each block, 128 words
/// for its half pixels, 8 for its texture.
TEST(Flow, CountsTheWordsOfTheMatching) {
  const cv::Mat scene = smooth_image(96, 8);
  work::Machine machine(machine_config(8, true));
  const auto estimator = make_estimator(true, {}, machine);
  const cv::Mat before = window(scene, 16, 16, kSide), now = window(scene, 15, 16, kSide);
  estimator->process({before.data, 0, 0, 0});
  machine.take_job();
  ASSERT_EQ(estimator->process({now.data, 0, 0, 0}).matched, 25);
  const work::Job job = machine.take_job();
  ASSERT_EQ(job.stages.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(job.stages[i].stage, kStages[i]);
  EXPECT_EQ(work::counts_of(job.stages[1])[Op::SimdSad], 25u * 8);
  EXPECT_EQ(work::counts_of(job.stages[2])[Op::SimdSad], 25u * (81 * 16 + 16 * 8));
  EXPECT_EQ(work::transferred_by(job.stages[0]).bytes, Bytes(kSide * kSide));
  EXPECT_EQ(work::transferred_by(job.stages[0]).transfers, 1);
}

TEST(Flow, RefusesWhatCannotBe) {
  using traces::testing::expect_input_error;
  work::Machine machine(machine_config(1, false));
  const auto refuse = [&](const Options& options, std::initializer_list<std::string> parts) {
    expect_input_error([&] { make_estimator(false, options, machine); }, parts);
  };
  Options options;
  options.side = 62;
  refuse(options, {"side is 62", "multiple of 4"});
  options.side = 16;
  refuse(options, {"side is 16", "at least 18 px"});
  options = {};
  options.grid = 48;
  refuse(options, {"grid is 48", "1 to 47"});
  options = {};
  options.search = 17;
  refuse(options, {"search is 17", "1 to 16"});
  options = {};
  options.grid = 3;
  refuse(options, {"min_matches is 10", "1 to 9"});
}

TEST(Flow, SaysWhichImageDoesNotFit) {
  work::Machine machine({.cores = 1, .memory = "L1", .capacity = Bytes(8000)});
  traces::testing::expect_input_error([&] { make_estimator(false, {}, machine); },
                                      {"image before", "L1", "192 bytes are missing"});
}

}  // namespace
}  // namespace leviosim::flow::testing
