// Kernels of the feature extraction in the form that suits the host: plain numbers, nothing
// counted. Each gives the bits of the kernels that it stands for, of which only what they count is
// left (host_value.h).
#pragma once

#include <array>
#include <cstdint>

#include "workload/math/host_value.h"
#include "workload/vision/fast.h"
#include "workload/vision/features.h"
#include "workload/vision/orientation.h"

namespace leviosim::vio::host {

/// Whether nine or more consecutive bits of the ring `bits` (one bit for each position) are set.
inline bool has_arc(std::uint32_t bits) {
  static_assert(kFastArc == 9);
  const std::uint32_t twice = bits | bits << kRingSize;
  const std::uint32_t two = twice & twice >> 1;
  const std::uint32_t four = two & two >> 2;
  const std::uint32_t eight = four & four >> 4;
  return (eight & twice >> 8) != 0;
}

/// FAST-9 (fast.h) at `centre`, a pixel of an image of `width` pixels a row. An arc of nine holds
/// at least two of the four pixels above, below, left and right, so most pixels are done after
/// these.
template <class Pixel>
bool is_corner(const Pixel* centre, int width, int threshold) {
  const auto level = [centre](int offset) { return static_cast<int>(centre[offset]); };
  const int upper = level(0) + threshold, lower = level(0) - threshold;
  int above = 0, below = 0;
  for (const int offset : {-3 * width, 3, 3 * width, -3}) {
    above += level(offset) > upper;
    below += level(offset) < lower;
  }
  if (above < 2 && below < 2) return false;
  std::uint32_t brighter = 0, darker = 0;
  for (int k = 0; k < kRingSize; ++k) {
    const int pixel = level(kRing[k].dy * width + kRing[k].dx);
    brighter |= static_cast<std::uint32_t>(pixel > upper) << k;
    darker |= static_cast<std::uint32_t>(pixel < lower) << k;
  }
  return has_arc(brighter) || has_arc(darker);
}

/// The Harris response (harris.h) at `centre`. The window, its gradients and a pixel more to the
/// right of each row must lie in the image.
template <class Pixel>
std::int32_t harris_response(const Pixel* centre, int width) {
  constexpr int kRadius = 3, kColumns = 8, kSumShift = 11;  // of 8 columns, the last one is outside
  std::int32_t a = 0, b = 0, c = 0;
  for (int v = -kRadius; v <= kRadius; ++v) {
    const Pixel* middle = centre + v * width - kRadius;
    std::int16_t gx[kColumns], gy[kColumns];
    for (int u = 0; u < kColumns; ++u) {
      const auto level = [&](int dx, int dy) {
        return static_cast<std::int16_t>(middle[dy * width + u + dx]);
      };
      const auto right_minus_left = [&](int dy) { return level(1, dy) - level(-1, dy); };
      const auto below_minus_above = [&](int dx) { return level(dx, 1) - level(dx, -1); };
      const int inside = u < kColumns - 1 ? -1 : 0;
      gx[u] = static_cast<std::int16_t>(
          inside & (right_minus_left(-1) + 2 * right_minus_left(0) + right_minus_left(1)));
      gy[u] = static_cast<std::int16_t>(
          inside & (below_minus_above(-1) + 2 * below_minus_above(0) + below_minus_above(1)));
    }
    for (int u = 0; u < kColumns; ++u) {
      a += std::int32_t{gx[u]} * gx[u];
      b += std::int32_t{gy[u]} * gy[u];
      c += std::int32_t{gx[u]} * gy[u];
    }
  }
  a >>= kSumShift;
  b >>= kSumShift;
  c >>= kSumShift;
  return a * b - c * c - (a + b) * (a + b) / 25;
}

/// A disc of radius 15 in rows of 32 pixels, the first of them 16 to the left of the centre. Of the
/// rows at the top and at the bottom it has the pixel in the middle at most.
struct DiscMask {
  static constexpr int kReach = kDiscRadius - 1;
  static constexpr int kRows = 2 * kReach + 1;
  static constexpr int kColumns = 32;
  static constexpr int kLeft = kColumns / 2;
  std::int16_t inside[kRows][kColumns];  ///< 1 or 0
  std::int16_t dx[kRows][kColumns];      ///< from the centre; 0 outside
  bool has_top_and_bottom;
};

/// The pixels at (dx, dy) with dx² + dy² < `squared_radius`, which is at most 15² + 1.
constexpr DiscMask make_disc_mask(int squared_radius) {
  DiscMask mask{};
  for (int row = 0; row < DiscMask::kRows; ++row)
    for (int column = 0; column < DiscMask::kColumns; ++column) {
      const int dx = column - DiscMask::kLeft, dy = row - DiscMask::kReach;
      if (dx * dx + dy * dy >= squared_radius) continue;
      mask.inside[row][column] = 1;
      mask.dx[row][column] = static_cast<std::int16_t>(dx);
    }
  mask.has_top_and_bottom = kDiscRadius * kDiscRadius < squared_radius;
  return mask;
}

/// First moments of the grey levels of the disc around `centre`; the disc's square must lie in the
/// image.
template <class Pixel>
Moments<work::Native> disc_moments(const DiscMask& disc, const Pixel* centre, int width) {
  std::int32_t m10 = 0, m01 = 0;
  for (int row = 0; row < DiscMask::kRows; ++row) {
    const int dy = row - DiscMask::kReach;
    const Pixel* pixels = centre + dy * width - DiscMask::kLeft;
    std::int32_t sum = 0;
    for (int i = 0; i < DiscMask::kColumns; ++i) {
      const auto level = static_cast<std::int16_t>(pixels[i]);
      sum += std::int32_t{disc.inside[row][i]} * level;
      m10 += std::int32_t{disc.dx[row][i]} * level;
    }
    m01 += dy * sum;
  }
  if (disc.has_top_and_bottom)
    m01 += kDiscRadius * (static_cast<std::int32_t>(centre[kDiscRadius * width]) -
                          static_cast<std::int32_t>(centre[-kDiscRadius * width]));
  return {m10, m01};
}

/// One word of a descriptor: bit k, the highest first, says whether the first point of pair k is
/// darker than the second.
/// @param pairs  those of the word, packed (point_pairs.h)
/// @param offset_of  (x, y) -> offset from `centre` of the pixel at which a point of the pattern
/// lies
template <class Pixel, class Word, class OffsetOf>
LEVIOSIM_HOST_INLINE std::uint32_t compare_pairs(const Pixel* centre, const Word* pairs,
                                                 OffsetOf&& offset_of) {
  std::int32_t first[kWordBits], second[kWordBits];
  for (int k = 0; k < kWordBits; ++k) {
    const auto pair = static_cast<std::int32_t>(work::value(pairs[k]));
    first[k] = offset_of(pair >> 24, pair << 8 >> 24);
    second[k] = offset_of(pair << 16 >> 24, pair << 24 >> 24);
  }
  std::uint32_t bits = 0;
  for (int k = 0; k < kWordBits; ++k)
    bits = bits << 1 | static_cast<std::uint32_t>(static_cast<int>(centre[first[k]]) <
                                                  static_cast<int>(centre[second[k]]));
  return bits;
}

}  // namespace leviosim::vio::host

namespace leviosim::vio {

/// What `counted` says of the pixel at index `centre`: whether it is a corner.
template <class P, class Counted>
LEVIOSIM_HOST_INLINE typename P::Bool is_corner_at(ConstImageView<P> image, int centre,
                                                   int threshold, Counted&& counted) {
  return host_value(counted, [&] {
    return typename P::Bool{host::is_corner(image.pixels.data() + centre, image.width, threshold)};
  });
}

/// What `counted` gives for the corner at index `centre`: its Harris response.
template <class P, class Counted>
LEVIOSIM_HOST_INLINE typename P::I32 response_at(ConstImageView<P> image, int centre,
                                                 Counted&& counted) {
  return host_value(counted, [&] {
    return typename P::I32(host::harris_response(image.pixels.data() + centre, image.width));
  });
}

/// What `counted` gives for the feature at index `centre`: the moments of `disc`.
template <class P, class Counted>
LEVIOSIM_HOST_INLINE Moments<P> moments_at(const host::DiscMask& disc, ConstImageView<P> image,
                                           int centre, Counted&& counted) {
  return host_value(counted, [&] {
    const auto plain = host::disc_moments(disc, image.pixels.data() + centre, image.width);
    return Moments<P>{plain.m10, plain.m01};
  });
}

}  // namespace leviosim::vio
