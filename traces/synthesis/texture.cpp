#include "traces/synthesis/texture.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "sim/base/check.h"
#include "sim/base/interruption.h"

namespace leviosim::traces {
namespace {

/// log2 of x >= 1, with straight lines between the powers of two: off by at most 0.09, which no eye
/// sees in a mip level, and the same on every host.
float coarse_log2(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return static_cast<float>(bits) * 0x1p-23f - 127.0f;
}

/// The two neighbours of a texel-centred coordinate, and the weight of the second.
struct Neighbours {
  int low;
  int high;
  float weight;
};

Neighbours neighbours(float coordinate, int size) {
  const float last = static_cast<float>(size - 1);
  const float centred = std::clamp(coordinate - 0.5f, 0.0f, last);
  const int low = static_cast<int>(centred);
  return {low, std::min(low + 1, size - 1), centred - static_cast<float>(low)};
}

}  // namespace

Texture::Texture(int width, int height, std::vector<std::uint8_t> texels)
    : levels_{{width, height, 0}}, texels_(std::move(texels)) {
  check(width > 0 && height > 0, "Texture: empty");
  check_equal(texels_.size(), static_cast<std::size_t>(width) * height, "Texture: texels");
  while (levels_.back().width > 1 && levels_.back().height > 1) add_half(Level(levels_.back()));
}

void Texture::add_half(const Level& from) {
  const Level half{from.width / 2, from.height / 2, texels_.size()};
  texels_.reserve(texels_.size() + static_cast<std::size_t>(half.width) * half.height);
  for (int y = 0; y < half.height; ++y) {
    throw_if_interrupted();
    for (int x = 0; x < half.width; ++x) {
      const std::uint8_t* top =
          texels_.data() + from.offset + static_cast<std::size_t>(2 * y) * from.width + 2 * x;
      const std::uint8_t* bottom = top + from.width;
      texels_.push_back(
          static_cast<std::uint8_t>((top[0] + top[1] + bottom[0] + bottom[1] + 2) / 4));
    }
  }
  levels_.push_back(half);
}

float Texture::bilinear(const Level& level, float u, float v) const {
  const Neighbours x = neighbours(u, level.width);
  const Neighbours y = neighbours(v, level.height);
  const std::uint8_t* top =
      texels_.data() + level.offset + static_cast<std::size_t>(y.low) * level.width;
  const std::uint8_t* bottom =
      texels_.data() + level.offset + static_cast<std::size_t>(y.high) * level.width;
  const auto along = [&x](const std::uint8_t* row) {
    const auto a = static_cast<float>(row[x.low]);
    const auto b = static_cast<float>(row[x.high]);
    return a + x.weight * (b - a);
  };
  const float a = along(top);
  const float b = along(bottom);
  return a + y.weight * (b - a);
}

float Texture::sample(float u, float v, float footprint) const {
  const float level = coarse_log2(std::max(1.0f, footprint));
  const auto last = static_cast<int>(levels_.size()) - 1;
  const int fine = std::min(static_cast<int>(level), last);
  const float fine_scale = 1.0f / static_cast<float>(1 << fine);
  const float fine_value = bilinear(levels_[fine], u * fine_scale, v * fine_scale);
  if (fine == last) return fine_value;
  const float coarse_value =
      bilinear(levels_[fine + 1], u * fine_scale * 0.5f, v * fine_scale * 0.5f);
  return fine_value + (level - static_cast<float>(fine)) * (coarse_value - fine_value);
}

}  // namespace leviosim::traces
