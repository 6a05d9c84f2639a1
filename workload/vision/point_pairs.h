// The pairs of points whose grey levels a descriptor compares, in the frame of the feature (x along
// its orientation), and how a core sees them: what the patterns of the profiles have in common.
//
// Left out: which pairs they are. Those of the shared extraction are drawn (pair_pattern.h), those
// of `levio` are learned (workload/levio/vision/learned_pairs.h).
#pragma once

#include <array>
#include <cstdint>

namespace leviosim::vio {

inline constexpr int kPairs = 256;
/// No point is farther from the feature than this, before rotation.
inline constexpr int kPatternRadius = 15;
/// Points of a pair that are closer than this are nearly equal, because of the blur.
inline constexpr int kMinPairDistance = 5;

struct PointPair {
  int x1, y1, x2, y2;
};

constexpr bool is_in_disc(int x, int y) { return x * x + y * y <= kPatternRadius * kPatternRadius; }

constexpr bool is_far_apart(const PointPair& pair) {
  const int along = pair.x2 - pair.x1;
  const int across = pair.y2 - pair.y1;
  return along * along + across * across >= kMinPairDistance * kMinPairDistance;
}

/// A pair packed for the core: x1, y1, x2, y2 as signed bytes from the top byte down. One load
/// fetches a pair.
constexpr std::uint32_t pack_pair(const PointPair& p) {
  constexpr auto byte = [](int v) { return static_cast<std::uint32_t>(v) & 0xffu; };
  return byte(p.x1) << 24 | byte(p.y1) << 16 | byte(p.x2) << 8 | byte(p.y2);
}

using PairWords = std::array<std::uint32_t, kPairs>;

/// A packed pattern in the scalars of the policy: a constant of the program image.
template <class P>
constexpr std::array<typename P::U32, kPairs> make_pair_pattern(const PairWords& words) {
  std::array<typename P::U32, kPairs> pattern{};
  for (int k = 0; k < kPairs; ++k) pattern[k] = typename P::U32(words[k]);
  return pattern;
}

}  // namespace leviosim::vio
