// The patterns of `levio`: learned anew here, looked at, and held against the drawn one on a flight
// that they were not learned on.
#include "workload/levio/vision/learned_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/support/pair_learner.h"
#include "tests/workload/vision/runs.h"
#include "workload/vision/pair_pattern.h"

namespace leviosim::vio::levio {
namespace {

using tests::Candidates;
using tests::PairBits;
using tests::PlainImage;
using tests::TurnedPatch;

std::vector<PointPair> unpacked(const PairWords& words) {
  std::vector<PointPair> pairs;
  for (const std::uint32_t word : words) pairs.push_back(tests::unpack_pair(word));
  return pairs;
}

TEST(LevioLearnedPairs, AreWhatTheLearnerMakesAnew) {
  const std::vector<TurnedPatch> patches = tests::turned_patches(tests::frames_of_flight(1));
  EXPECT_EQ(tests::learn_pairs(patches, Candidates::FarApart).words, kLearnedPairWords)
      << "renew the table with leviosim_learn_pairs";
  EXPECT_EQ(tests::learn_pairs(patches, Candidates::NotSideBySide).words, kReleasedPairWords)
      << "renew the table with leviosim_learn_pairs";
}

/// A pattern, and how far apart the points of its pairs lie at least.
struct Pattern {
  const PairWords& words;
  double distance;
};
class LevioPattern : public ::testing::TestWithParam<Pattern> {};
INSTANTIATE_TEST_SUITE_P(Both, LevioPattern,
                         ::testing::Values(Pattern{kLearnedPairWords, 5},
                                           Pattern{kReleasedPairWords, std::sqrt(8.0)}));

TEST_P(LevioPattern, LiesInTheDiscAndPointsLieApart) {
  double nearest = 30;
  for (const PointPair& p : unpacked(GetParam().words)) {
    EXPECT_LE(std::hypot(p.x1, p.y1), 15);
    EXPECT_LE(std::hypot(p.x2, p.y2), 15);
    nearest = std::min(nearest, std::hypot(p.x2 - p.x1, p.y2 - p.y1));
  }
  EXPECT_GE(nearest, GetParam().distance);
  EXPECT_LT(nearest, GetParam().distance + 1);
}

TEST_P(LevioPattern, HasNoPairTwiceInEitherOrder) {
  std::vector<std::array<int, 4>> pairs;
  for (const PointPair& p : unpacked(GetParam().words)) {
    pairs.push_back({p.x1, p.y1, p.x2, p.y2});
    pairs.push_back({p.x2, p.y2, p.x1, p.y1});
  }
  std::sort(pairs.begin(), pairs.end());
  EXPECT_EQ(std::adjacent_find(pairs.begin(), pairs.end()), pairs.end());
}

/// How much the bits of a pattern have in common, over many features: the less, the better.
struct Redundancy {
  double correlation = 0;  ///< of two bits, without sign: mean
  double largest = 0;      ///< … of the most alike
  double first_bias = 0;   ///< of the first 64 bits, the distance of the mean from 1/2: mean
};

Redundancy redundancy(const PairWords& words, const std::vector<TurnedPatch>& patches) {
  std::vector<PairBits> bits;
  for (const PointPair& pair : unpacked(words)) bits.emplace_back(pair, patches);
  Redundancy result;
  constexpr std::size_t kFirst = 64;
  for (std::size_t k = 0; k < kFirst; ++k)
    result.first_bias +=
        static_cast<double>(bits[k].bias()) / (2.0 * static_cast<double>(patches.size()) * kFirst);
  for (std::size_t a = 0; a < bits.size(); ++a)
    for (std::size_t b = a + 1; b < bits.size(); ++b) {
      const double correlation = std::abs(bits[a].correlation_with(bits[b]));
      result.correlation += correlation / (kPairs * (kPairs - 1) / 2);
      result.largest = std::max(result.largest, correlation);
    }
  return result;
}

/// The last pairs that are taken are biased, more than drawn ones: the method rather takes those
/// than pairs that are alike.
TEST_P(LevioPattern, IsLessAlikeOnAnotherFlightThanADrawnOne) {
  const std::vector<TurnedPatch> patches = tests::turned_patches(tests::frames_of_flight(2));
  ASSERT_GT(patches.size(), 1000u);
  const Redundancy learned = redundancy(GetParam().words, patches);
  const Redundancy drawn = redundancy(kPairWords, patches);
  EXPECT_LT(learned.correlation, 0.8 * drawn.correlation);
  EXPECT_LT(learned.largest, 0.5);
  EXPECT_GT(drawn.largest, 0.8);
  EXPECT_LT(learned.first_bias, 0.5 * drawn.first_bias);
}

TEST(PairLearner, ComparesWhatTheExtractorCompares) {
  const cv::Mat picture = vision_test::rectangle_image(tests::kImageWidth, tests::kImageHeight, 3);
  const vision_test::Features features = vision_test::extract_as_levio<work::Native>(picture);
  PlainImage image(picture.begin<std::uint8_t>(), picture.end<std::uint8_t>());
  const std::vector<TurnedPatch> patches = tests::turned_patches(image);
  ASSERT_GT(patches.size(), 100u);
  ASSERT_EQ(patches.size(), features.size());
  const std::vector<PointPair> pattern = unpacked(kLearnedPairWords);
  for (std::size_t i = 0; i < patches.size(); ++i)
    for (std::size_t k = 0; k < pattern.size(); ++k)
      ASSERT_EQ(patches[i].first_is_darker(pattern[k]),
                (features[i].words[k / 32] >> (31 - k % 32) & 1u) != 0)
          << "feature " << i << ", pair " << k;
}

/// By points that lie in the disc.
TEST(PairLearner, CandidatesAreAllPairsOfTheGridThatLieApart) {
  std::vector<std::pair<int, int>> points;
  for (int x = -14; x <= 14; x += 2)
    for (int y = -14; y <= 14; y += 2)
      if (x * x + y * y <= 225) points.emplace_back(x, y);
  for (const auto& [candidates, distance] : {std::pair{Candidates::NotSideBySide, std::sqrt(8.0)},
                                             std::pair{Candidates::FarApart, 5.0}}) {
    const std::vector<PointPair> pairs = tests::candidate_pairs(candidates);
    std::size_t expected = 0;
    for (const auto& [x1, y1] : points)
      for (const auto& [x2, y2] : points)
        if (std::hypot(x2 - x1, y2 - y1) > distance - 1e-9) ++expected;
    EXPECT_EQ(2 * pairs.size(), expected);
    for (const PointPair& p : pairs) {
      EXPECT_TRUE(p.x1 % 2 == 0 && p.y1 % 2 == 0 && p.x2 % 2 == 0 && p.y2 % 2 == 0);
      EXPECT_GT(std::hypot(p.x2 - p.x1, p.y2 - p.y1), distance - 1e-9);
    }
  }
}

/// Four features; a pair's first point is darker where its bit is to be 1.
TEST(PairLearner, BiasAndCorrelationAreThoseOfTheBits) {
  const PointPair a{-6, 0, 0, 0}, b{6, 0, 0, 0}, c{0, 6, 0, 0}, never{0, -6, 0, 0};
  std::vector<TurnedPatch> patches(4);
  for (int i = 0; i < 4; ++i) {
    patches[i].at(0, 0) = 1;
    patches[i].at(-6, 0) = i < 2 ? 0 : 2;      // 1100
    patches[i].at(6, 0) = i < 3 ? 0 : 2;       // 1110
    patches[i].at(0, 6) = i % 2 == 0 ? 0 : 2;  // 1010
    patches[i].at(0, -6) = 1;                  // equal: 0000
  }
  const PairBits bits_a(a, patches), bits_b(b, patches), bits_c(c, patches);
  const PairBits bits_never(never, patches);
  EXPECT_EQ(bits_a.bias(), 0);
  EXPECT_EQ(bits_b.bias(), 2);
  EXPECT_EQ(bits_never.bias(), 4);
  // (2/4 - 2/4 · 3/4) / √(1/4 · 3/16) = 1 / √3.
  EXPECT_NEAR(bits_a.correlation_with(bits_b), 1 / std::sqrt(3.0), 1e-12);
  EXPECT_FALSE(bits_a.differs_from(bits_b, 57));
  EXPECT_TRUE(bits_a.differs_from(bits_b, 58));
  EXPECT_EQ(bits_a.correlation_with(bits_c), 0);
  EXPECT_TRUE(bits_a.differs_from(bits_c, 15));
  const PairBits turned({0, 0, -6, 0}, patches);
  EXPECT_EQ(bits_a.correlation_with(turned), -1);
  EXPECT_FALSE(bits_a.differs_from(turned, 100));
  EXPECT_FALSE(bits_a.differs_from(bits_never, 100)) << "a bit that never changes tells nothing";
}

}  // namespace
}  // namespace leviosim::vio::levio
