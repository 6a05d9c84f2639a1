#include "tools/app/images/feature_tracks.h"

#include <algorithm>
#include <cmath>

#include "sim/work/machine.h"
#include "workload/vio/profile.h"
#include "workload/vision/extractor.h"
#include "workload/vision/hamming.h"
#include "workload/vision/harris.h"
#include "workload/vision/matcher.h"
#include "workload/vision/patch_alignment.h"

namespace leviosim::tools {
namespace {

using Native = work::Native;

constexpr std::size_t kNone = static_cast<std::size_t>(-1);
constexpr Bytes kMemory{std::int64_t{1} << 26};

template <class T>
work::NativeSpan<T> span_of(std::vector<T>& values) {
  return {values.data(), static_cast<int>(values.size())};
}

vio::Profile profile() { return vio::profile_named("next", 1); }

/// Sums of squares and products of gradients in the 7x7 window around a pixel.
Eigen::Matrix2d structure_tensor(const traces::GrayImage& image, int x, int y) {
  constexpr int kRadius = 3;
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  const auto at = [&](int u, int v) {
    return static_cast<double>(image.pixels[static_cast<std::size_t>(v) * image.width + u]);
  };
  for (int v = y - kRadius; v <= y + kRadius; ++v)
    for (int u = x - kRadius; u <= x + kRadius; ++u) {
      const Eigen::Vector2d gradient(at(u + 1, v) - at(u - 1, v), at(u, v + 1) - at(u, v - 1));
      sum += gradient * gradient.transpose();
    }
  return sum;
}

FeatureSeen describe(const traces::GrayImage& image, const Eigen::Vector2d& pixel) {
  FeatureSeen seen;
  seen.pixel = pixel;
  const auto x = static_cast<int>(std::lround(pixel.x()));
  const auto y = static_cast<int>(std::lround(pixel.y()));
  const work::NativeSpan<const std::uint8_t> pixels(image.pixels.data(),
                                                    static_cast<int>(image.pixels.size()));
  seen.corner = vio::harris_response<Native>(pixels, image.width, x, y);
  // Its eigenvalues are mean ± half, the greater one across the edge.
  const Eigen::Matrix2d tensor = structure_tensor(image, x, y);
  const double mean = 0.5 * tensor.trace();
  const double half = std::hypot(0.5 * (tensor(0, 0) - tensor(1, 1)), tensor(0, 1));
  const double across = 0.5 * std::atan2(2 * tensor(0, 1), tensor(0, 0) - tensor(1, 1));
  seen.roundness = mean + half > 0 ? std::max(0.0, mean - half) / (mean + half) : 1;
  seen.edge = {-std::sin(across), std::cos(across)};
  return seen;
}

}  // namespace

struct FeatureTracker::View {
  traces::GrayImage image;
  std::vector<std::uint16_t> x, y;  ///< in units of 1 / subpixel_steps px
  std::vector<std::uint32_t> words;
  std::vector<std::size_t> tracks;  ///< of each feature
  int count() const { return static_cast<int>(x.size()); }
  Eigen::Vector2d pixel(int i, int steps) const {
    const auto at = static_cast<std::size_t>(i);
    return Eigen::Vector2d(x[at], y[at]) / steps;
  }
};

FeatureTracker::FeatureTracker(traces::ImageSize size) : size_(size) {}
FeatureTracker::~FeatureTracker() = default;

FeatureTracker::View FeatureTracker::extract(const traces::GrayImage& image) const {
  View view;
  view.image = image;
  work::Machine machine({1, "memory", kMemory, 4, false});
  const auto stage = machine.stage("features");
  const vio::ExtractorOptions options = profile().extractor;
  auto list =
      vio::alloc_features<Native>(machine.local(), options.max_features(size_.width, size_.height));
  vio::extract_features<Native>(machine, {span_of(view.image.pixels), size_.width, size_.height, 0},
                                options, list);
  view.x.assign(list.x.data(), list.x.data() + list.count);
  view.y.assign(list.y.data(), list.y.data() + list.count);
  view.words.assign(list.descriptors.data(),
                    list.descriptors.data() + vio::kDescriptorWords * list.count);
  return view;
}

std::size_t FeatureTracker::alike(View& view) {
  constexpr double kElsewhere = 8;  // px
  const vio::Profile next = profile();
  const vio::DescriptorWords<Native> words = span_of(view.words);
  std::size_t count = 0;
  for (int i = 0; i < view.count(); ++i) {
    const auto held = vio::hold_descriptor<Native>(words, i);
    const Eigen::Vector2d here = view.pixel(i, next.extractor.subpixel_steps);
    for (int j = 0; j < view.count(); ++j)
      if ((view.pixel(j, next.extractor.subpixel_steps) - here).norm() > kElsewhere &&
          vio::hamming_distance<Native>(held, words, j) < next.matcher.max_distance) {
        ++count;
        break;
      }
  }
  return count;
}

/// Features of `now` that have a match whose patches agree go on with its track; the rest begin
/// one.
std::size_t FeatureTracker::continue_tracks(View& now) const {
  const vio::Profile next = profile();
  now.tracks.assign(now.x.size(), kNone);
  if (last_ == nullptr || now.count() == 0) return 0;
  work::Machine machine({1, "memory", kMemory, 4, false});
  const auto stage = machine.stage("matches");
  auto matches = vio::alloc_matches<Native>(machine.local(), now.count());
  vio::match_two_way<Native>(machine, span_of(now.words), now.count(), span_of(last_->words),
                             last_->count(), next.matcher, matches);
  const auto view = [this](View& of) -> vio::PatchView<Native> {
    return {vio::ImageView<Native>{span_of(of.image.pixels), size_.width, size_.height, 0},
            span_of(of.x), span_of(of.y)};
  };
  std::vector<std::uint8_t> verdicts(now.x.size());
  vio::align_patches<Native>(machine, view(*last_), view(now), next.extractor.subpixel_steps,
                             next.patches.max_shift, next.patches, matches, span_of(verdicts));
  std::size_t kept = 0;
  for (int i = 0; i < matches.count; ++i) {
    if (static_cast<vio::PatchVerdict>(verdicts[static_cast<std::size_t>(i)]) ==
        vio::PatchVerdict::Disagrees)
      continue;
    now.tracks[matches.query[i]] = last_->tracks[matches.reference[i]];
    ++kept;
  }
  return kept;
}

void FeatureTracker::add(const traces::GrayImage& image) {
  auto now = std::make_unique<View>(extract(image));
  const std::size_t matches = continue_tracks(*now);
  result_.frames.push_back({now->x.size(), matches, alike(*now)});
  for (int i = 0; i < now->count(); ++i) {
    std::size_t& track = now->tracks[static_cast<std::size_t>(i)];
    if (track == kNone) {
      track = result_.tracks.size();
      result_.tracks.emplace_back();
    }
    FeatureSeen seen = describe(image, now->pixel(i, profile().extractor.subpixel_steps));
    seen.frame = result_.frames.size() - 1;
    result_.tracks[track].push_back(seen);
  }
  last_ = std::move(now);
}

}  // namespace leviosim::tools
