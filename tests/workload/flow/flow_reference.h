// The optical flow of workload/flow in plain words, pixel by pixel, and images to try it on.
#pragma once

#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "sim/work/machine.h"
#include "tests/workload/vision/test_images.h"
#include "workload/flow/estimator.h"
#include "workload/flow/options.h"

namespace leviosim::flow::testing {

using vio::vision_test::Random;

/// Grey levels without neighbours that are alike, smoothed so that half pixels mean something.
inline cv::Mat smooth_image(int side, std::uint64_t seed, int passes = 2) {
  cv::Mat image = vio::vision_test::noise_image(side, side, seed);
  for (int pass = 0; pass < passes; ++pass) {
    const cv::Mat from = image.clone();
    for (int y = 1; y < side - 1; ++y)
      for (int x = 1; x < side - 1; ++x) {
        int sum = 0;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) sum += from.at<std::uint8_t>(y + dy, x + dx);
        image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(sum / 9);
      }
  }
  return image;
}

/// The part of an image from (x, y) on.
inline cv::Mat window(const cv::Mat& image, int x, int y, int side) {
  return image(cv::Rect(x, y, side, side)).clone();
}

/// What was published, without regard for how a chip would do it.
class Reference {
 public:
  Reference(const cv::Mat& before, const cv::Mat& now, const Options& options)
      : before_(before), now_(now), options_(options) {}

  Flow flow() const {
    Flow result;
    std::map<int, int> xs, ys;
    for (const auto& [x, y] : places()) {
      if (texture(x, y) <= options_.min_texture) continue;
      ++result.textured;
      const Match match = best(x, y);
      if (match.difference >= options_.max_difference) continue;
      ++result.matched;
      const auto [hx, hy] = best_half(x, y, match);
      ++xs[2 * match.dx + hx];
      ++ys[2 * match.dy + hy];
    }
    if (result.matched < options_.min_matches) return result;
    result.x = vote(xs);
    result.y = vote(ys);
    result.quality = result.matched * 255 / options_.blocks();
    return result;
  }

 private:
  struct Match {
    int dx = 0, dy = 0, difference = 1 << 30;
  };

  std::vector<std::pair<int, int>> places() const {
    const int room = options_.side - 2 * (options_.search + 1) - kBlock;
    const auto place = [&](int k) {
      return options_.search + 1 + k * room / std::max(1, options_.grid - 1);
    };
    std::vector<std::pair<int, int>> all;
    for (int j = 0; j < options_.grid; ++j)
      for (int i = 0; i < options_.grid; ++i) all.emplace_back(place(i), place(j));
    return all;
  }
  static int level(const cv::Mat& image, int x, int y) { return image.at<std::uint8_t>(y, x); }

  int texture(int x, int y) const {
    int sum = 0;
    for (int j = y + 2; j < y + 6; ++j)
      for (int i = x + 2; i < x + 6; ++i)
        sum += std::abs(level(before_, i, j) - level(before_, i + 1, j)) +
               std::abs(level(before_, i, j) - level(before_, i, j + 1));
    return sum;
  }
  Match best(int x, int y) const {
    Match best;
    for (int dy = -options_.search; dy <= options_.search; ++dy)
      for (int dx = -options_.search; dx <= options_.search; ++dx) {
        int sum = 0;
        for (int j = 0; j < kBlock; ++j)
          for (int i = 0; i < kBlock; ++i)
            sum += std::abs(level(before_, x + i, y + j) - level(now_, x + i + dx, y + j + dy));
        if (sum < best.difference) best = {dx, dy, sum};
      }
    return best;
  }
  /// The level half a pixel to the left or right, or of the pixel itself.
  int across(int x, int y, int hx) const {
    return (level(now_, x, y) + level(now_, x + hx, y)) / 2;
  }
  int between(int x, int y, int hx, int hy) const {
    return (across(x, y, hx) + across(x, y + hy, hx)) / 2;
  }
  std::pair<int, int> best_half(int x, int y, const Match& match) const {
    constexpr std::array<std::pair<int, int>, 8> kDirections = {
        {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
    std::pair<int, int> best{0, 0};
    int least = match.difference;
    for (const auto& [hx, hy] : kDirections) {
      int sum = 0;
      for (int j = 0; j < kBlock; ++j)
        for (int i = 0; i < kBlock; ++i)
          sum += std::abs(level(before_, x + i, y + j) -
                          between(x + i + match.dx, y + j + match.dy, hx, hy));
      if (sum < least) {
        least = sum;
        best = {hx, hy};
      }
    }
    return best;
  }
  static int vote(const std::map<int, int>& histogram) {
    int fullest = 0, most = 0;
    for (const auto& [bin, n] : histogram)
      if (n > most) fullest = bin, most = n;
    int sum = 0, number = 0;
    for (const auto& [bin, n] : histogram)
      if (std::abs(bin - fullest) <= 2) sum += n * bin, number += n;
    return static_cast<int>(std::floor(128.0 * sum / number));
  }

  const cv::Mat& before_;
  const cv::Mat& now_;
  Options options_;
};

inline work::MachineConfig machine_config(int cores, bool record) {
  return {
      .cores = cores, .memory = "L1", .capacity = Bytes(1 << 20), .alignment = 4, .record = record};
}

/// The flow between two images, the angles turned meanwhile in radians.
inline Flow flow_between(bool counting, const cv::Mat& before, const cv::Mat& now,
                         const Options& options = {}, int cores = 8, float turn_x = 0,
                         float turn_y = 0) {
  work::Machine machine(machine_config(cores, counting));
  const auto estimator = make_estimator(counting, options, machine);
  estimator->process({before.data, 0, 0, 0});
  return estimator->process({now.data, turn_x, turn_y, 1.0f});
}

/// All that is not a rate or a time.
inline std::array<int, 5> figures(const Flow& flow) {
  return {flow.x, flow.y, flow.quality, flow.textured, flow.matched};
}

}  // namespace leviosim::flow::testing
