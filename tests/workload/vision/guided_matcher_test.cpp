// Guided matching against a plain search, and at each of its limits.
#include "workload/vision/guided_matcher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/workload/vision/runs.h"

namespace leviosim::vio::vision_test {
namespace {

constexpr int kSteps = 4;
constexpr int kWidth = 160, kHeight = 120;
constexpr int kMaxAge = 10;
/// Powers of two, so that landmarks at a depth of 1 m lie at whole coordinates.
constexpr PinholeCamera kCamera{.fx = 64, .fy = 64, .cx = 80, .cy = 60};

/// Where the image shows it, in quarters of a pixel, and how far away it is.
struct Landmark {
  Feature seen;
  float depth = 1;
  int age = 0;
};

template <class P>
std::vector<PlainMatch> match_landmarks(const std::vector<Landmark>& landmarks,
                                        const Features& features, int cores,
                                        const GuidedOptions& options) {
  std::vector<typename P::F32> points;
  std::vector<typename P::Byte> ages;
  Features seen;
  for (const Landmark& l : landmarks) {
    const auto at = [&](int steps, float centre) {
      return (static_cast<float>(steps) / kSteps - centre) / 64 * l.depth;
    };
    for (const float x : {at(l.seen.x, kCamera.cx), at(l.seen.y, kCamera.cy), l.depth})
      points.emplace_back(x);
    ages.push_back(work::narrow<typename P::Byte>(typename P::I32(l.age)));
    seen.push_back(l.seen);
  }
  std::vector<typename P::U16> x, y;
  for (const Feature& f : features) {
    x.push_back(work::narrow<typename P::U16>(typename P::I32(f.x)));
    y.push_back(work::narrow<typename P::U16>(typename P::I32(f.y)));
  }
  auto words = words_of<P>(features);
  auto landmark_words = words_of<P>(seen);
  work::Machine machine = make_machine<P>(cores);
  const auto stage = machine.stage("world matching");
  const work::Arena::Frame frame(machine.local());
  const int count = static_cast<int>(features.size());
  FeatureList<P> list;
  list.x = span_of<P>(x);
  list.y = span_of<P>(y);
  list.descriptors = span_of<P>(words);
  list.count = list.capacity = count;
  GuidedInput<P> input;
  input.points = span_of<P>(points);
  input.descriptors = span_of<P>(landmark_words);
  input.ages = span_of<P>(ages);
  input.landmarks = static_cast<int>(landmarks.size());
  input.max_age = kMaxAge;
  input.T_camera_world = Pose<P>::identity();
  input.camera = kCamera;
  input.width = kWidth;
  input.height = kHeight;
  input.steps = kSteps;
  MatchList<P> out = alloc_matches<P>(machine.local(), count);
  match_guided<P>(machine, input, list, options, out);
  std::vector<PlainMatch> matches;
  for (int i = 0; i < out.count; ++i)
    matches.push_back({out.query.data()[i], out.reference.data()[i], out.distance.data()[i]});
  return matches;
}

/// Of equally near features the first by cell and number; of equally near landmarks the first.
std::vector<PlainMatch> searched_plainly(const std::vector<Landmark>& landmarks,
                                         const Features& features, const GuidedOptions& options) {
  const int radius = static_cast<int>(options.radius_px * kSteps), side = options.cell_px * kSteps;
  std::vector<int> order(features.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  const auto cell = [&](int i) {
    const Feature& f = features[static_cast<std::size_t>(i)];
    return std::pair(f.y / side, f.x / side);
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return cell(a) < cell(b); });
  std::map<int, PlainMatch> owners;
  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    const Landmark& landmark = landmarks[l];
    if (landmark.age > kMaxAge || landmark.depth <= options.min_depth) continue;
    PlainMatch best{-1, static_cast<int>(l), options.max_distance};
    for (const int i : order) {
      const Feature& f = features[static_cast<std::size_t>(i)];
      const int dx = f.x - landmark.seen.x, dy = f.y - landmark.seen.y;
      if (dx * dx + dy * dy > radius * radius) continue;
      const int distance = distance_between(f, landmark.seen);
      if (distance < best.distance) best = {i, best.reference, distance};
    }
    if (best.query < 0) continue;
    const auto [owner, is_first] = owners.try_emplace(best.query, best);
    if (!is_first && best.distance < owner->second.distance) owner->second = best;
  }
  std::vector<PlainMatch> matches;
  for (const auto& [feature, match] : owners) matches.push_back(match);
  return matches;
}

std::uint32_t with_flips(Random& random, std::uint32_t word) {
  for (int k = random.between(0, 9); k > 0; --k) word ^= 1u << random.between(0, 31);
  return word;
}

TEST(GuidedMatcher, AgreesWithAPlainSearch) {
  Random random(71);
  std::vector<Landmark> landmarks;
  Features features;
  for (int l = 0; l < 200; ++l) {
    Landmark landmark{
        {random.between(1, kSteps * kWidth - 1), random.between(1, kSteps * kHeight - 1), {}},
        random.between(0, 1) == 0 ? 1.0f : 2.0f,
        random.between(0, kMaxAge + 3)};
    for (std::uint32_t& word : landmark.seen.words) word = random.bits();
    landmarks.push_back(landmark);
    for (int copy = random.between(0, 2); copy > 0; --copy) {
      Feature near = landmark.seen;
      near.x = std::clamp(near.x + random.between(-40, 40), 0, kSteps * kWidth - 1);
      near.y = std::clamp(near.y + random.between(-40, 40), 0, kSteps * kHeight - 1);
      for (std::uint32_t& word : near.words) word = with_flips(random, word);
      features.push_back(near);
    }
  }
  for (const GuidedOptions& options :
       {GuidedOptions{}, GuidedOptions{.radius_px = 12, .max_distance = 40, .cell_px = 5}}) {
    const auto expected = searched_plainly(landmarks, features, options);
    ASSERT_GT(expected.size(), 40u);
    ASSERT_LT(expected.size(), features.size());
    for (const int cores : {1, 8}) {
      EXPECT_EQ(match_landmarks<work::Native>(landmarks, features, cores, options), expected);
      EXPECT_EQ(match_landmarks<work::Counting>(landmarks, features, cores, options), expected);
    }
  }
}

/// Whether one landmark finds the one feature.
bool finds(const Landmark& landmark, const Feature& feature, const GuidedOptions& options = {}) {
  return !match_landmarks<work::Native>({landmark}, {feature}, 1, options).empty();
}

TEST(GuidedMatcher, TheRadiusIsInclusive) {
  const Landmark landmark{{320, 240, {}}};
  for (const auto& [dx, dy] : {std::pair(32, 0), std::pair(0, -32), std::pair(-32, 0)}) {
    EXPECT_TRUE(finds(landmark, {320 + dx, 240 + dy, {}}));
    EXPECT_FALSE(finds(landmark, {320 + dx + (dx > 0) - (dx < 0), 240 + dy - (dy < 0), {}}));
  }
  EXPECT_FALSE(finds(landmark, {320 + 23, 240 + 23, {}}));
  EXPECT_TRUE(finds(landmark, {320 + 22, 240 + 23, {}}));
}

TEST(GuidedMatcher, AgeIsInclusiveDistanceAndDepthAreExclusive) {
  Landmark landmark{{320, 240, {}}};
  landmark.age = kMaxAge;
  EXPECT_TRUE(finds(landmark, landmark.seen));
  landmark.age = kMaxAge + 1;
  EXPECT_FALSE(finds(landmark, landmark.seen));
  landmark.age = 0;
  Feature other = landmark.seen;
  other.words[3] = 0xffu;
  EXPECT_FALSE(finds(landmark, other, {.max_distance = 8}));
  EXPECT_TRUE(finds(landmark, other, {.max_distance = 9}));
  landmark.depth = 2;
  EXPECT_FALSE(finds(landmark, landmark.seen, {.min_depth = 2}));
  EXPECT_TRUE(finds(landmark, landmark.seen, {.min_depth = 1.9f}));
  landmark.depth = -1;
  EXPECT_FALSE(finds(landmark, landmark.seen));
}

TEST(GuidedMatcher, LandmarksBesideTheImageAreNotLookedFor) {
  for (const auto& [x, y] : {std::pair(0, 100), std::pair(kSteps * kWidth, 100), std::pair(100, 0),
                             std::pair(100, kSteps * kHeight)}) {
    const Feature beside{
        std::clamp(x, 1, kSteps * kWidth - 1), std::clamp(y, 1, kSteps * kHeight - 1), {}};
    EXPECT_FALSE(finds({{x, y, {}}}, beside)) << x << ' ' << y;
    EXPECT_TRUE(finds({beside}, beside)) << x << ' ' << y;
  }
}

}  // namespace
}  // namespace leviosim::vio::vision_test
