#include "traces/synthesis/world.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "traces/synthesis/texture.h"

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

}  // namespace leviosim::traces
