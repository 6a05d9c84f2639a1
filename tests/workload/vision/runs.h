// Running the extraction and matching stages in tests, with results in plain values.
#pragma once

#include <array>
#include <vector>

#include "sim/work/machine.h"
#include "tests/workload/vision/test_images.h"
#include "workload/levio/vision/levio_extractor.h"
#include "workload/vision/extractor.h"
#include "workload/vision/matcher.h"

namespace leviosim::vio::vision_test {

struct Feature {
  int x, y;
  std::array<std::uint32_t, kDescriptorWords> words;
  friend bool operator==(const Feature&, const Feature&) = default;
};
using Features = std::vector<Feature>;

template <class P>
work::Machine make_machine(int cores) {
  return work::Machine({cores, "L1", Bytes(4 << 20), 4, P::kCounting});
}

template <class P>
Features plain(const FeatureList<P>& list) {
  Features features;
  for (int i = 0; i < list.count; ++i) {
    Feature f{list.x.data()[i], list.y.data()[i], {}};
    for (int w = 0; w < kDescriptorWords; ++w)
      f.words[w] = work::value(list.descriptors.data()[kDescriptorWords * i + w]);
    features.push_back(f);
  }
  return features;
}

/// @param extract  extract_features(), shared or of levio
template <class P, class Extract>
Features extract_by(Extract&& extract, work::Machine& machine, const cv::Mat& image,
                    const ExtractorOptions& options) {
  PolicyImage<P> copy(image);
  const auto stage = machine.stage("feature extraction");
  const work::Arena::Frame frame(machine.local());
  FeatureList<P> list =
      alloc_features<P>(machine.local(), options.max_features(image.cols, image.rows));
  extract(machine, copy.view(), options, list);
  return plain<P>(list);
}
template <class P>
Features extract(work::Machine& machine, const cv::Mat& image,
                 const ExtractorOptions& options = {}) {
  return extract_by<P>(vio::extract_features<P>, machine, image, options);
}
template <class P>
Features extract(const cv::Mat& image, int cores = 8, const ExtractorOptions& options = {}) {
  work::Machine machine = make_machine<P>(cores);
  return extract<P>(machine, image, options);
}

/// As the front end of `levio` does it.
template <class P>
Features extract_as_levio(const cv::Mat& image, int cores = 8, const ExtractorOptions& options = {},
                          levio::DescriptorKind kind = levio::DescriptorKind::Exact) {
  const auto extract = [kind](work::Machine& machine, ImageView<P> picture,
                              const ExtractorOptions& how, FeatureList<P>& list) {
    levio::extract_features<P>(machine, picture, how, kind, list);
  };
  work::Machine machine = make_machine<P>(cores);
  return extract_by<P>(extract, machine, image, options);
}

struct PlainMatch {
  int query, reference, distance;
  friend bool operator==(const PlainMatch&, const PlainMatch&) = default;
};

template <class P>
std::vector<typename P::U32> words_of(const Features& features) {
  std::vector<typename P::U32> words;
  for (const Feature& f : features) words.insert(words.end(), f.words.begin(), f.words.end());
  return words;
}

/// @param matcher  match_two_way() of everything else, or that of `levio`
template <class P>
std::vector<PlainMatch> match_by(decltype(&match_two_way<P>) matcher, work::Machine& machine,
                                 const Features& current, const Features& reference,
                                 const MatcherOptions& options = {}) {
  auto current_words = words_of<P>(current);
  auto reference_words = words_of<P>(reference);
  const auto stage = machine.stage("frame matching");
  const work::Arena::Frame frame(machine.local());
  MatchList<P> list = alloc_matches<P>(machine.local(), static_cast<int>(current.size()));
  matcher(machine, span_of<P>(current_words), static_cast<int>(current.size()),
          span_of<P>(reference_words), static_cast<int>(reference.size()), options, list);
  std::vector<PlainMatch> matches;
  for (int i = 0; i < list.count; ++i)
    matches.push_back({list.query.data()[i], list.reference.data()[i], list.distance.data()[i]});
  return matches;
}
template <class P>
std::vector<PlainMatch> match(work::Machine& machine, const Features& current,
                              const Features& reference, const MatcherOptions& options = {}) {
  return match_by<P>(match_two_way<P>, machine, current, reference, options);
}
template <class P>
std::vector<PlainMatch> match(const Features& current, const Features& reference, int cores = 8,
                              const MatcherOptions& options = {}) {
  work::Machine machine = make_machine<P>(cores);
  return match<P>(machine, current, reference, options);
}

inline int distance_between(const Feature& a, const Feature& b) {
  int distance = 0;
  for (int w = 0; w < kDescriptorWords; ++w)
    for (std::uint32_t bits = a.words[w] ^ b.words[w]; bits != 0; bits &= bits - 1) ++distance;
  return distance;
}

}  // namespace leviosim::vio::vision_test
