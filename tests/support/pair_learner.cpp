#include "tests/support/pair_learner.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "sim/base/check.h"
#include "sim/work/machine.h"
#include "tests/support/temporary_folder.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/image_source.h"
#include "traces/synthesis/synthetic.h"
#include "workload/levio/vision/levio_blur.h"
#include "workload/levio/vision/levio_descriptor.h"
#include "workload/levio/vision/levio_extractor.h"
#include "workload/vio/profile.h"

namespace leviosim::tests {
namespace {

using N = work::Native;
using vio::PointPair;

struct Place {
  int x, y;
};

/// Where `levio` finds features; its pattern has no part in that.
std::vector<Place> features_of(vio::ImageView<N> image) {
  const vio::ExtractorOptions options = vio::profile_named("levio", 1).extractor;
  work::Machine machine({1, "L1", Bytes(1 << 20), 4, false});
  const auto stage = machine.stage("feature extraction");
  auto list =
      vio::alloc_features<N>(machine.local(), options.max_features(image.width, image.height));
  vio::levio::extract_features<N>(machine, image, options, vio::levio::DescriptorKind::Exact, list);
  std::vector<Place> places;
  places.reserve(static_cast<std::size_t>(list.count));
  for (int i = 0; i < list.count; ++i) places.push_back({list.x[i], list.y[i]});
  return places;
}

TurnedPatch turned_patch(N::Span<const N::Byte> blurred, int centre) {
  const auto direction =
      vio::direction_of<N>(vio::levio::disc_moments<N>(blurred, kImageWidth, centre));
  TurnedPatch patch;
  for (int y = -vio::kPatternRadius; y <= vio::kPatternRadius; ++y)
    for (int x = -vio::kPatternRadius; x <= vio::kPatternRadius; ++x)
      if (vio::is_in_disc(x, y))
        patch.at(x, y) = static_cast<std::uint8_t>(
            blurred[vio::levio::ExactDescriptor::index<N>(kImageWidth, centre, direction, x, y)]);
  return patch;
}

}  // namespace

std::vector<PlainImage> frames_of_flight(std::uint64_t seed) {
  const TemporaryFolder folder("pair_learner");
  traces::SyntheticOptions options;
  options.seed = seed;
  options.duration_s = 20;
  options.camera.rate_hz = 1;
  traces::write_synthetic_flight(folder / "flight", options);
  const traces::Dataset data = traces::open_asl(folder / "flight");
  const traces::ImageSource source(data, {kImageWidth, kImageHeight});
  std::vector<PlainImage> images;
  for (std::size_t i = 0; i < source.size(); ++i) images.push_back(source.read(i).pixels);
  return images;
}

std::vector<TurnedPatch> turned_patches(PlainImage& image) {
  const vio::ImageView<N> view{
      {image.data(), kImageWidth * kImageHeight}, kImageWidth, kImageHeight};
  PlainImage levels(image.size());
  const vio::ImageView<N> blurred{
      {levels.data(), kImageWidth * kImageHeight}, kImageWidth, kImageHeight};
  vio::levio::blur_rows<N>(view, blurred, 0, kImageHeight);
  std::vector<TurnedPatch> patches;
  for (const Place& at : features_of(view))
    patches.push_back(turned_patch(blurred.pixels, at.y * kImageWidth + at.x));
  return patches;
}

std::vector<TurnedPatch> turned_patches(std::vector<PlainImage> images) {
  std::vector<TurnedPatch> all;
  for (PlainImage& image : images) {
    const std::vector<TurnedPatch> patches = turned_patches(image);
    all.insert(all.end(), patches.begin(), patches.end());
  }
  return all;
}

PairBits::PairBits(const PointPair& pair, const std::vector<TurnedPatch>& patches)
    : words_((patches.size() + 63) / 64), features_(static_cast<std::int64_t>(patches.size())) {
  for (std::size_t i = 0; i < patches.size(); ++i)
    if (patches[i].first_is_darker(pair)) {
      words_[i / 64] |= std::uint64_t{1} << (i % 64);
      ++ones_;
    }
}

std::int64_t PairBits::bias() const { return std::abs(2 * ones_ - features_); }

/// Times the square of the number of features, as variance().
std::int64_t PairBits::covariance_with(const PairBits& other) const {
  std::int64_t both = 0;
  for (std::size_t w = 0; w < words_.size(); ++w)
    both += std::popcount(words_[w] & other.words_[w]);
  return features_ * both - ones_ * other.ones_;
}

bool PairBits::differs_from(const PairBits& other, int hundredths) const {
  // Up to features⁴/16 · 10⁴ must fit in 63 bits.
  check(features_ <= 10'000, "products of whole numbers do not overflow");
  const std::int64_t scaled = 100 * covariance_with(other);
  return scaled * scaled < hundredths * hundredths * variance() * other.variance();
}

double PairBits::correlation_with(const PairBits& other) const {
  const std::int64_t squares = variance() * other.variance();
  if (squares == 0) return 0;
  return static_cast<double>(covariance_with(other)) / std::sqrt(static_cast<double>(squares));
}

PointPair unpack_pair(std::uint32_t word) {
  const auto coordinate = [word](int byte) {
    return static_cast<int>(static_cast<std::int8_t>(word >> (8 * byte) & 0xffu));
  };
  return {coordinate(3), coordinate(2), coordinate(1), coordinate(0)};
}

namespace {

constexpr int kGrid = 2;

bool may_be_chosen(const PointPair& pair, Candidates candidates) {
  if (candidates == Candidates::FarApart) return vio::is_far_apart(pair);
  return std::abs(pair.x2 - pair.x1) + std::abs(pair.y2 - pair.y1) > kGrid;
}

}  // namespace

std::vector<PointPair> candidate_pairs(Candidates candidates) {
  constexpr int kLast = vio::kPatternRadius / kGrid * kGrid;
  std::vector<Place> points;
  for (int y = -kLast; y <= kLast; y += kGrid)
    for (int x = -kLast; x <= kLast; x += kGrid)
      if (vio::is_in_disc(x, y)) points.push_back({x, y});
  std::vector<PointPair> pairs;
  for (std::size_t a = 0; a < points.size(); ++a)
    for (std::size_t b = a + 1; b < points.size(); ++b) {
      const PointPair pair{points[a].x, points[a].y, points[b].x, points[b].y};
      if (may_be_chosen(pair, candidates)) pairs.push_back(pair);
    }
  return pairs;
}

namespace {

struct Candidate {
  PointPair pair;
  PairBits bits;
};

/// Of all candidates in turn, those that differ from every one before, until there are enough.
std::vector<const Candidate*> take(const std::vector<Candidate>& candidates, int hundredths) {
  std::vector<const Candidate*> taken;
  for (const Candidate& candidate : candidates) {
    const bool differs = std::all_of(taken.begin(), taken.end(), [&](const Candidate* other) {
      return candidate.bits.differs_from(other->bits, hundredths);
    });
    if (differs) taken.push_back(&candidate);
    if (taken.size() == vio::kPairs) break;
  }
  return taken;
}

}  // namespace

LearnedPairs learn_pairs(std::vector<TurnedPatch> patches, Candidates allowed) {
  check(patches.size() >= LearnedPairs::kFeatures, "a flight has the features to learn from");
  patches.resize(LearnedPairs::kFeatures);
  std::vector<Candidate> candidates;
  for (const PointPair& pair : candidate_pairs(allowed))
    candidates.push_back({pair, PairBits(pair, patches)});
  // Of equals, the one that comes first on the grid.
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.bits.bias() < b.bits.bias(); });
  LearnedPairs learned{{}, LearnedPairs::kFirstLimit};
  std::vector<const Candidate*> taken = take(candidates, learned.limit);
  while (taken.size() < vio::kPairs) {
    learned.limit += LearnedPairs::kStep;
    check(learned.limit < 100, "the features tell as many pairs apart as a pattern has");
    taken = take(candidates, learned.limit);
  }
  for (std::size_t k = 0; k < taken.size(); ++k) learned.words[k] = vio::pack_pair(taken[k]->pair);
  return learned;
}

}  // namespace leviosim::tests
