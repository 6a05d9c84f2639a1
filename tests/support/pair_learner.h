// Learns a pattern of point pairs as ORB learned its own (Rublee et al. 2011, "Learning good binary
// features"), on flights that the project draws itself. Candidates are the pairs of points of a
// grid. Each gives a bit for every feature. Those whose bits are 1 as often as 0 come first, and
// one is taken if its bits hardly agree with those of any pair taken before.
//
// Whole numbers decide, so every compiler learns the same pattern. Left out: recorded data.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "workload/vision/point_pairs.h"

namespace leviosim::tests {

/// Blurred grey levels around a feature of `levio`, turned into its orientation: what its
/// descriptor compares.
class TurnedPatch {
 public:
  std::uint8_t& at(int x, int y) { return levels_[index(x, y)]; }
  std::uint8_t at(int x, int y) const { return levels_[index(x, y)]; }
  /// The bit of a descriptor.
  bool first_is_darker(const vio::PointPair& pair) const {
    return at(pair.x1, pair.y1) < at(pair.x2, pair.y2);
  }

 private:
  static constexpr int kSide = 2 * vio::kPatternRadius + 1;
  static constexpr std::size_t index(int x, int y) {
    return static_cast<std::size_t>((y + vio::kPatternRadius) * kSide + x + vio::kPatternRadius);
  }
  std::array<std::uint8_t, kSide * kSide> levels_{};
};

/// An image of the pipeline's size.
using PlainImage = std::vector<std::uint8_t>;
inline constexpr int kImageWidth = 160, kImageHeight = 120;

/// Of the synthetic flight of this seed, one frame in each of its 20 s.
std::vector<PlainImage> frames_of_flight(std::uint64_t seed);

/// Of all features that `levio` finds in the image, in its order.
std::vector<TurnedPatch> turned_patches(PlainImage& image);
std::vector<TurnedPatch> turned_patches(std::vector<PlainImage> images);

/// The bits that a pair gives for many features.
class PairBits {
 public:
  PairBits(const vio::PointPair& pair, const std::vector<TurnedPatch>& patches);

  /// How far the bit is from being 1 for half of the features, in halves of a feature.
  std::int64_t bias() const;
  /// Whether the correlation of the bits, of either sign, is below this many hundredths.
  bool differs_from(const PairBits& other, int hundredths) const;
  double correlation_with(const PairBits& other) const;

 private:
  std::int64_t covariance_with(const PairBits& other) const;
  std::int64_t variance() const { return ones_ * (features_ - ones_); }

  std::vector<std::uint64_t> words_;
  std::int64_t features_, ones_ = 0;
};

vio::PointPair unpack_pair(std::uint32_t word);

/// Which pairs of points a pattern may have: how far apart they lie at least.
enum class Candidates {
  NotSideBySide,  ///< all of the grid but neighbours in a row or a column: 2.8 px
  FarApart        ///< as far as the blur is wide, 5 px, as ORB has it
};

/// The pairs of points on a grid of 2 px that a pattern may have, each in one order.
std::vector<vio::PointPair> candidate_pairs(Candidates candidates);

struct LearnedPairs {
  static constexpr std::size_t kFeatures = 3000;  ///< that a pattern is learned from
  /// Two pairs of a pattern correlate by less than the limit, in hundredths, which rises until
  /// there are enough.
  static constexpr int kFirstLimit = 15, kStep = 3;

  vio::PairWords words;
  int limit;  ///< the last one
};

/// A pattern for features that look like the first LearnedPairs::kFeatures of these.
LearnedPairs learn_pairs(std::vector<TurnedPatch> patches, Candidates candidates);

}  // namespace leviosim::tests
