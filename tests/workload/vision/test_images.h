// Images for the tests of workload/vision, and the way to hand them to kernels of either policy.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "sim/work/policy.h"
#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/image_source.h"
#include "workload/vision/features.h"

namespace leviosim::vio::vision_test {

/// SplitMix64.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint32_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<std::uint32_t>((z ^ (z >> 31)) >> 32);
  }
  /// In low … high, both included.
  int between(int low, int high) {
    return low + static_cast<int>(bits() % static_cast<std::uint32_t>(high - low + 1));
  }

 private:
  std::uint64_t state_;
};

/// Independent grey levels: many corners, nothing smooth.
inline cv::Mat noise_image(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(height, width, CV_8U);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random.bits() & 255u);
  return image;
}

/// Overlapping rectangles of random levels with a little noise: edges, corners and flat areas.
inline cv::Mat rectangle_image(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(height, width, CV_8U, cv::Scalar(128));
  const int rectangles = width * height / 60;
  for (int n = 0; n < rectangles; ++n) {
    const int x0 = random.between(-8, width - 1), y0 = random.between(-8, height - 1);
    const int x1 = x0 + random.between(4, 24), y1 = y0 + random.between(4, 24);
    const auto level = static_cast<std::uint8_t>(random.between(10, 245));
    for (int y = std::max(0, y0); y < std::min(height, y1); ++y)
      for (int x = std::max(0, x0); x < std::min(width, x1); ++x)
        image.at<std::uint8_t>(y, x) = level;
  }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      auto& level = image.at<std::uint8_t>(y, x);
      level = static_cast<std::uint8_t>(level + random.between(-3, 3));
    }
  return image;
}

/// Rotates a square image by a quarter turn: (x, y) moves to (side - 1 - y, x).
inline cv::Mat quarter_turn(const cv::Mat& image) {
  cv::Mat turned(image.cols, image.rows, CV_8U);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      turned.at<std::uint8_t>(x, image.rows - 1 - y) = image.at<std::uint8_t>(y, x);
  return turned;
}

/// A copy of an image in the storage of a policy.
template <class P>
class PolicyImage {
 public:
  using Byte = typename P::Byte;

  PolicyImage(int width, int height)
      : pixels_(static_cast<std::size_t>(width) * height), width_(width), height_(height) {}
  explicit PolicyImage(const cv::Mat& image) : PolicyImage(image.cols, image.rows) {
    for (int y = 0; y < height_; ++y)
      std::memcpy(static_cast<void*>(pixels_.data() + y * width_), image.ptr(y),
                  static_cast<std::size_t>(width_));
  }

  ImageView<P> view() {
    return {typename P::template Span<Byte>(pixels_.data(), width_ * height_), width_, height_};
  }
  int at(int x, int y) const { return static_cast<int>(pixels_[y * width_ + x]); }

 private:
  std::vector<Byte> pixels_;
  int width_, height_;
};

/// A constant table in the storage of a policy.
template <class P, class Constant>
auto local_copy(const Constant& constant) {
  return std::vector<typename Constant::value_type>(constant.begin(), constant.end());
}
template <class P, class T>
typename P::template Span<T> span_of(std::vector<T>& values) {
  return {values.data(), static_cast<int>(values.size())};
}

/// The recorded flight, as the pipeline sees it; empty where the data are absent.
inline std::vector<cv::Mat> recorded_frames(std::size_t begin, std::size_t end, std::size_t step) {
  const auto folder = traces::testing::recorded_data() / "euroc" / "MH_01_easy_t05_t20";
  if (!std::filesystem::exists(folder)) return {};
  const traces::ImageSource source(traces::open_asl(folder), {160, 120});
  std::vector<cv::Mat> frames;
  for (std::size_t i = begin; i < std::min(end, source.size()); i += step) {
    traces::GrayImage image = source.read(i);
    frames.push_back(cv::Mat(image.height, image.width, CV_8U, image.pixels.data()).clone());
  }
  return frames;
}
inline constexpr const char* kNoRecordedData =
    "no recorded flight: set LEVIOSIM_DATA to the folder that contains euroc/";

}  // namespace leviosim::vio::vision_test
