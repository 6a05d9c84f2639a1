#include "traces/synthesis/screen_bounds.h"

#include <array>
#include <cstddef>

namespace leviosim::traces {
namespace {

constexpr float kNearest = 1e-3f;  // [m]
constexpr std::size_t kCorners = 8;

void extend(ScreenBounds& bounds, const Eigen::Vector3f& point) {
  bounds.extend(Eigen::Vector2f(point.head<2>() / point.z()));
}

/// The point at which the edge from a (in front) to b (behind) leaves the visible half-space.
Eigen::Vector3f clipped(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return a + (a.z() - kNearest) / (a.z() - b.z()) * (b - a);
}

}  // namespace

ScreenBounds screen_bounds(const Box& box, const Eigen::Isometry3f& T_camera_world) {
  std::array<Eigen::Vector3f, kCorners> corners;
  for (std::size_t i = 0; i < kCorners; ++i)
    corners[i] = T_camera_world * Eigen::Vector3f(i & 1 ? box.max.x() : box.min.x(),
                                                  i & 2 ? box.max.y() : box.min.y(),
                                                  i & 4 ? box.max.z() : box.min.z());
  ScreenBounds bounds;
  for (std::size_t i = 0; i < kCorners; ++i) {
    if (corners[i].z() < kNearest) continue;
    extend(bounds, corners[i]);
    for (const std::size_t axis : {1, 2, 4})
      if (const Eigen::Vector3f& other = corners[i ^ axis]; other.z() < kNearest)
        extend(bounds, clipped(corners[i], other));
  }
  return bounds;
}

}  // namespace leviosim::traces
