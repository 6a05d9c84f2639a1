#include "traces/synthesis/world.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "sim/base/check.h"
#include "sim/base/interruption.h"

namespace leviosim::traces {
namespace {

struct FaceAxes {
  int u, v;
};
constexpr std::array<FaceAxes, 3> kFaceAxes{{{1, 2}, {0, 2}, {0, 1}}};

/// Where a ray is inside a box: it enters at `near` through `near_axis`, leaves at `far`.
struct Crossing {
  float near, far;
  int near_axis, far_axis;
};

Crossing cross(const Box& box, const Eigen::Vector3f& origin, const Eigen::Vector3f& inverse) {
  Crossing crossing{-INFINITY, INFINITY, 0, 0};
  for (int axis = 0; axis < 3; ++axis) {
    const float a = (box.min[axis] - origin[axis]) * inverse[axis];
    const float b = (box.max[axis] - origin[axis]) * inverse[axis];
    const float enter = std::min(a, b);
    const float leave = std::max(a, b);
    if (enter > crossing.near) {
      crossing.near = enter;
      crossing.near_axis = axis;
    }
    if (leave < crossing.far) {
      crossing.far = leave;
      crossing.far_axis = axis;
    }
  }
  return crossing;
}

/// How much of the lamp, 0 to 1, is seen by a ray that a face mirrors: a wide highlight (Phong
/// 1975) around one direction, as from windows far away.
float lamp_in(int axis, const Eigen::Vector3f& direction) {
  static const Eigen::Vector3f lamp = Eigen::Vector3f(0.5f, 0.35f, 0.79f).normalized();
  Eigen::Vector3f mirrored = direction;
  mirrored[axis] = -mirrored[axis];
  const float cosine = std::max(0.0f, mirrored.dot(lamp));
  const float squared = cosine * cosine;
  return squared * squared * squared;
}

}  // namespace

World::World(Box room, std::vector<Box> objects)
    : room_(std::move(room)), objects_(std::move(objects)), all_(objects_.size()) {
  std::iota(all_.begin(), all_.end(), 0);
}

Hit World::cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                std::span<const int> candidates) const {
  const Eigen::Vector3f inverse = direction.cwiseInverse();
  const Crossing out = cross(room_, origin, inverse);
  Hit hit{out.far, &room_, 2 * out.far_axis + (direction[out.far_axis] > 0 ? 1 : 0)};
  for (const int candidate : candidates) {
    const Box& box = objects_[static_cast<std::size_t>(candidate)];
    const Crossing in = cross(box, origin, inverse);
    if (in.near > in.far || in.near <= 0 || in.near >= hit.reach) continue;
    hit = {in.near, &box, 2 * in.near_axis + (direction[in.near_axis] > 0 ? 0 : 1)};
  }
  return hit;
}

Hit World::cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const {
  return cast(origin, direction, all_);
}

float World::grey(const Hit& hit, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                  float pixel_angle) {
  const Surface& surface = hit.box->faces[static_cast<std::size_t>(hit.face)];
  const int axis = hit.face / 2;
  const FaceAxes axes = kFaceAxes[static_cast<std::size_t>(axis)];
  const Eigen::Vector3f offset = origin + hit.reach * direction - hit.box->min;
  // A pixel covers distance * angle across and 1 / cos(incidence) of that along the slope; the
  // texture is averaged over the geometric mean of the two.
  const float length = direction.norm();
  const float cosine = std::max(0.02f, std::abs(direction[axis]) / length);
  const float footprint_m = hit.reach * length * pixel_angle / std::sqrt(cosine);
  const float painted =
      surface.light * surface.texture.sample(offset[axes.u] * surface.texels_per_m,
                                             offset[axes.v] * surface.texels_per_m,
                                             footprint_m * surface.texels_per_m);
  if (surface.gloss == 0) return painted;
  return painted + surface.gloss * lamp_in(axis, direction / length);
}

Box plain_box(const Eigen::Vector3f& min, const Eigen::Vector3f& max, std::uint8_t grey) {
  Box box;
  box.min = min;
  box.max = max;
  for (Surface& face : box.faces) face.texture = Texture(1, 1, {grey});
  return box;
}

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
