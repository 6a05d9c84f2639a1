// The 256 pairs of points whose grey levels a descriptor compares, in the frame of the feature
// (x along its orientation).
//
// The pattern is our own, drawn at compile time by a fixed rule (no learned table): every
// coordinate is a sum of four uniform 16-bit numbers, which is nearly normal, scaled to the
// standard deviation that Calonder et al. (2010, BRIEF) found best, a fifth of the patch size: 31 /
// 5 = 6.2 px. A pair is drawn again
//   - if one of its points leaves the disc of radius 15, in which rotations keep it;
//   - if its points are closer than kMinPairDistance, where the blur makes them nearly equal;
//   - if it lies more along the orientation than across it: grey levels rise along the orientation,
//     so nearly all features would agree in its bit (Rublee et al. 2011 saw this bias, and learned
//     their pattern to avoid it);
//   - if the pair was there before, in either order.
// Generator: SplitMix64 (Steele et al. 2014).
#pragma once

#include <array>
#include <cstdint>

#include "sim/work/policy.h"

namespace leviosim::vio {

inline constexpr int kPairs = 256;
/// No point is farther from the feature than this, before rotation.
inline constexpr int kPatternRadius = 15;
inline constexpr int kMinPairDistance = 5;

struct PointPair {
  int x1, y1, x2, y2;
};

class PairGenerator {
 public:
  /// A pair that is admissible by itself.
  constexpr PointPair next() {
    for (;;) {
      const PointPair pair = {coordinate(), coordinate(), coordinate(), coordinate()};
      if (inside(pair.x1, pair.y1) && inside(pair.x2, pair.y2) && apart(pair)) return pair;
    }
  }

 private:
  static constexpr bool inside(int x, int y) {
    return x * x + y * y <= kPatternRadius * kPatternRadius;
  }

  static constexpr bool apart(const PointPair& pair) {
    const int along = pair.x2 - pair.x1;
    const int across = pair.y2 - pair.y1;
    return along * along + across * across >= kMinPairDistance * kMinPairDistance &&
           along * along <= across * across;
  }

  /// The standard deviation of a sum of four uniform 16-bit numbers is 2^16 / sqrt(3) = 37 837;
  /// divided by 6103 it is 6.2.
  constexpr int coordinate() {
    constexpr int kMean = 4 * 65535 / 2;
    constexpr int kScale = 6103;
    std::uint64_t bits = draw();
    int sum = -kMean;
    for (int i = 0; i < 4; ++i) {
      sum += static_cast<int>(bits & 0xffff);
      bits >>= 16;
    }
    return sum < 0 ? -((kScale / 2 - sum) / kScale) : (kScale / 2 + sum) / kScale;
  }

  constexpr std::uint64_t draw() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  std::uint64_t state_ = 0;
};

/// The pattern packed for the core: one word per pair holds x1, y1, x2, y2 as signed bytes from the
/// top byte down. One load fetches a pair.
constexpr std::uint32_t pack_pair(const PointPair& p) {
  constexpr auto byte = [](int v) { return static_cast<std::uint32_t>(v) & 0xffu; };
  return byte(p.x1) << 24 | byte(p.y1) << 16 | byte(p.x2) << 8 | byte(p.y2);
}

constexpr std::array<std::uint32_t, kPairs> make_pair_words() {
  std::array<std::uint32_t, kPairs> words{};
  PairGenerator generator;
  for (int n = 0; n < kPairs;) {
    const PointPair pair = generator.next();
    const std::uint32_t word = pack_pair(pair);
    const std::uint32_t swapped = pack_pair({pair.x2, pair.y2, pair.x1, pair.y1});
    bool known = false;
    for (int k = 0; k < n; ++k) known = known || words[k] == word || words[k] == swapped;
    if (!known) words[n++] = word;
  }
  return words;
}
inline constexpr std::array<std::uint32_t, kPairs> kPairWords = make_pair_words();

/// The packed pattern in the scalars of the policy: a constant of the program image.
template <class P>
constexpr std::array<typename P::U32, kPairs> make_pair_pattern() {
  std::array<typename P::U32, kPairs> pattern{};
  for (int k = 0; k < kPairs; ++k) pattern[k] = typename P::U32(kPairWords[k]);
  return pattern;
}
template <class P>
inline constexpr auto kPairPattern = make_pair_pattern<P>();

}  // namespace leviosim::vio
