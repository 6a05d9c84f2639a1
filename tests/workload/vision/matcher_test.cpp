// Two-way matching against a plain reference and OpenCV's brute-force matcher, and its rules one by
// one.
#include "workload/vision/matcher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/features2d.hpp>

#include "sim/work/machine.h"
#include "tests/workload/vision/runs.h"
#include "workload/levio/vision/levio_matcher.h"

namespace leviosim::vio::vision_test {
namespace {

Features random_features(int n, std::uint64_t seed) {
  Random random(seed);
  Features features(static_cast<std::size_t>(n), Feature{0, 0, {}});
  for (Feature& f : features)
    for (std::uint32_t& word : f.words) word = random.bits();
  return features;
}

Feature with_flipped_bits(Feature f, int first, int count) {
  for (int k = first; k < first + count; ++k) f.words[k / 32] ^= 1u << (k % 32);
  return f;
}

/// Noisy copies of features drawn from `reference`, several of the same one among them.
Features noisy_copies(const Features& reference, int n, std::uint64_t seed) {
  Random random(seed);
  Features copies;
  for (int i = 0; i < n; ++i) {
    const auto source =
        static_cast<std::size_t>(random.between(0, static_cast<int>(reference.size()) - 1));
    const int flips = random.between(0, 44);
    copies.push_back(with_flipped_bits(reference[source], random.between(0, 256 - flips), flips));
  }
  return copies;
}

/// One-way matches by OpenCV, then the filter in plain words.
std::vector<PlainMatch> reference_matches(const Features& current, const Features& reference) {
  const auto rows = [](const Features& features) {
    cv::Mat m(static_cast<int>(features.size()), 32, CV_8U);
    for (std::size_t i = 0; i < features.size(); ++i)
      std::memcpy(m.ptr(static_cast<int>(i)), features[i].words.data(), 32);
    return m;
  };
  std::vector<cv::DMatch> found;
  cv::BFMatcher(cv::NORM_HAMMING).match(rows(current), rows(reference), found);
  std::vector<PlainMatch> one_way;
  for (const cv::DMatch& m : found)
    if (m.distance < 35) one_way.push_back({m.queryIdx, m.trainIdx, static_cast<int>(m.distance)});
  std::vector<PlainMatch> kept;
  for (const PlainMatch& m : one_way) {
    const auto claims = std::count_if(one_way.begin(), one_way.end(), [&](const PlainMatch& other) {
      return other.reference == m.reference && other.distance <= m.distance;
    });
    if (claims == 1) kept.push_back(m);  // its own
  }
  return kept;
}

TEST(VisionMatcher, AgreesWithOpenCvAndThePlainFilter) {
  const Features reference = random_features(300, 50);
  const Features current = noisy_copies(reference, 400, 51);
  const std::vector<PlainMatch> expected = reference_matches(current, reference);
  ASSERT_GT(expected.size(), 100u);
  ASSERT_LT(expected.size(), 300u);
  EXPECT_EQ(match<work::Native>(current, reference), expected);
}

TEST(VisionMatcher, DoesNotDependOnPolicyOrCores) {
  const Features reference = random_features(61, 52);
  const Features current = noisy_copies(reference, 101, 53);
  const std::vector<PlainMatch> expected = reference_matches(current, reference);
  for (const int cores : {1, 3, 8}) {
    EXPECT_EQ(match<work::Native>(current, reference, cores), expected) << cores;
    EXPECT_EQ(match<work::Counting>(current, reference, cores), expected) << cores;
  }
}

TEST(VisionMatcher, TheLimitIsExclusive) {
  const Features reference = random_features(1, 54);
  const auto count_at = [&](int distance) {
    return match<work::Native>({with_flipped_bits(reference[0], 100, distance)}, reference).size();
  };
  EXPECT_EQ(count_at(0), 1u);
  EXPECT_EQ(count_at(34), 1u);
  EXPECT_EQ(count_at(35), 0u);
  const Features current = {with_flipped_bits(reference[0], 0, 35)};
  EXPECT_EQ(match<work::Native>(current, reference, 8, {.max_distance = 36}).size(), 1u);
}

TEST(VisionMatcher, OfEquallyNearReferencesTheFirstIsTaken) {
  const Feature f = random_features(1, 55)[0];
  const Features reference = {with_flipped_bits(f, 0, 9), with_flipped_bits(f, 20, 7),
                              with_flipped_bits(f, 40, 7)};
  const std::vector<PlainMatch> expected = {{0, 1, 7}};
  EXPECT_EQ(match<work::Native>({f}, reference), expected);
}

TEST(VisionMatcher, TheBetterOfTwoClaimsStays) {
  const Features reference = random_features(4, 56);
  const Features current = {with_flipped_bits(reference[2], 0, 8),
                            with_flipped_bits(reference[2], 0, 5),
                            with_flipped_bits(reference[2], 0, 6)};
  const std::vector<PlainMatch> expected = {{1, 2, 5}};
  EXPECT_EQ(match<work::Native>(current, reference), expected);
}

TEST(VisionMatcher, EqualClaimsAreBothDropped) {
  const Features reference = random_features(3, 57);
  const Features current = {with_flipped_bits(reference[1], 0, 5), reference[0],
                            with_flipped_bits(reference[1], 9, 5)};
  const std::vector<PlainMatch> expected = {{1, 0, 0}};
  for (const int cores : {1, 3, 8})
    EXPECT_EQ(match<work::Native>(current, reference, cores), expected);
}

TEST(VisionMatcher, EmptyListsGiveNoMatches) {
  const Features some = random_features(5, 58);
  EXPECT_TRUE(match<work::Native>({}, some).empty());
  EXPECT_TRUE(match<work::Native>(some, {}).empty());
  EXPECT_TRUE(match<work::Counting>({}, {}).empty());
}

/// A sum of 8 bits is brought into its range after each of 8 words, for each of 80 × 100 pairs.
TEST(VisionMatcher, OfLevioFindsTheSameAndBringsSumsIntoTheirRange) {
  const Features reference = random_features(100, 61);
  const Features current = noisy_copies(reference, 80, 62);
  const auto run = [&](auto matcher) {
    work::Machine machine = make_machine<work::Counting>(8);
    std::vector<PlainMatch> found = match_by<work::Counting>(matcher, machine, current, reference);
    return std::pair(std::move(found), work::counts_of(machine.take_job().stages[0]));
  };
  const auto [expected, shared] = run(match_two_way<work::Counting>);
  const auto [found, levio] = run(levio::match_two_way<work::Counting>);
  ASSERT_GT(expected.size(), 30u);
  EXPECT_EQ(found, expected);
  work::Counts more = shared;
  more[work::Op::IntAlu] += 8u * 80u * 100u;
  EXPECT_EQ(levio, more);
}

TEST(VisionMatcher, RecordsTwoForksAndTheCompactions) {
  work::Machine machine = make_machine<work::Counting>(8);
  const Features reference = random_features(100, 59);
  const Features current = noisy_copies(reference, 80, 60);
  match<work::Counting>(machine, current, reference);
  const work::StageRun stage = machine.take_job().stages[0];
  ASSERT_EQ(stage.steps.size(), 4u);
  const auto& search = std::get<work::Fork>(stage.steps[0]);
  EXPECT_EQ(search.name, "search");
  EXPECT_TRUE(std::holds_alternative<work::Serial>(stage.steps[1]));
  EXPECT_EQ(std::get<work::Fork>(stage.steps[2]).name, "two-way filter");
  EXPECT_TRUE(std::holds_alternative<work::Serial>(stage.steps[3]));
  // 8 words for each of 80 × 100 pairs, and once for each current feature.
  work::Counts sum;
  for (const work::Counts& share : search.shares) sum += share;
  EXPECT_EQ(sum[work::Op::Popcount], 8u * 80u * 100u);
  EXPECT_EQ(sum[work::Op::LoadStream], 8u * 80u * 100u + 8u * 80u);
  // Two lists of 6 bytes per match and one word per core.
  EXPECT_EQ(stage.memory.parallel, Bytes(2 * 6 * 80 + 8 * 4));
}

TEST(VisionMatcher, MatchesRecordedFrames) {
  const std::vector<cv::Mat> frames = recorded_frames(0, 300, 5);
  if (frames.empty()) GTEST_SKIP() << kNoRecordedData;
  double matches = 0, shift = 0;
  Features previous = extract<work::Native>(frames[0]);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Features current = extract<work::Native>(frames[i]);
    for (const PlainMatch& m : match<work::Native>(current, previous)) {
      const Feature& a = current[static_cast<std::size_t>(m.query)];
      const Feature& b = previous[static_cast<std::size_t>(m.reference)];
      shift += std::abs(a.x - b.x) + std::abs(a.y - b.y) < 40 ? 1 : 0;
      ++matches;
    }
    previous = current;
  }
  EXPECT_GT(matches / static_cast<double>(frames.size() - 1), 60);
  // Wrong matches are spread over the image; right ones are not, a quarter of a second later.
  EXPECT_GT(shift / matches, 0.8);
}

}  // namespace
}  // namespace leviosim::vio::vision_test
