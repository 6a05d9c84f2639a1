// The 256 pairs of points of the shared extraction's descriptor; `levio` has others
// (workload/levio/vision/learned_pairs.h).
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

#include "workload/vision/point_pairs.h"

namespace leviosim::vio {

class PairGenerator {
 public:
  /// A pair that is admissible by itself.
  constexpr PointPair next() {
    for (;;) {
      const PointPair pair = {coordinate(), coordinate(), coordinate(), coordinate()};
      if (is_in_disc(pair.x1, pair.y1) && is_in_disc(pair.x2, pair.y2) && is_far_apart(pair) &&
          lies_across(pair))
        return pair;
    }
  }

 private:
  static constexpr bool lies_across(const PointPair& pair) {
    const int along = pair.x2 - pair.x1;
    const int across = pair.y2 - pair.y1;
    return along * along <= across * across;
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

constexpr PairWords make_pair_words() {
  PairWords words{};
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
inline constexpr PairWords kPairWords = make_pair_words();

template <class P>
inline constexpr auto kPairPattern = make_pair_pattern<P>(kPairWords);

}  // namespace leviosim::vio
