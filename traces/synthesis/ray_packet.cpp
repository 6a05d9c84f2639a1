#include "traces/synthesis/ray_packet.h"

#include <cstddef>

#include "sim/base/check.h"

namespace leviosim::traces {
namespace {

// std::min and std::max return references, which keeps the compiler from vectorising them.
float lesser(float a, float b) { return b < a ? b : a; }

float greater(float a, float b) { return a < b ? b : a; }

}  // namespace

void RayPacket::aim(const Eigen::Vector3f& origin, const Eigen::Matrix3f& R_world_camera,
                    std::span<const Eigen::Vector3f> rays) {
  check(rays.size() <= kMost, "RayPacket: too many rays");
  origin_ = origin;
  size_ = static_cast<int>(rays.size());
  for (int i = 0; i < size_; ++i) {
    const Eigen::Vector3f direction = R_world_camera * rays[static_cast<std::size_t>(i)];
    for (int axis = 0; axis < 3; ++axis) along_[axis][i] = direction[axis];
  }
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < size_; ++i) inverse_[axis][i] = 1 / along_[axis][i];
}

void RayPacket::cast_room(const Box& room) {
  const Eigen::Vector3f low = room.min - origin_;
  const Eigen::Vector3f high = room.max - origin_;
  for (int i = 0; i < size_; ++i) {
    const auto leave = [&](int axis) {
      return greater(low[axis] * inverse_[axis][i], high[axis] * inverse_[axis][i]);
    };
    reach_[i] = lesser(lesser(leave(0), leave(1)), leave(2));
    object_[i] = kRoom;
  }
}

void RayPacket::cast_object(const Box& box, int index) {
  const Eigen::Vector3f low = box.min - origin_;
  const Eigen::Vector3f high = box.max - origin_;
  const float low_x = low.x(), low_y = low.y(), low_z = low.z();
  const float high_x = high.x(), high_y = high.y(), high_z = high.z();
  const float* const x = inverse_[0].data();
  const float* const y = inverse_[1].data();
  const float* const z = inverse_[2].data();
  float* const reach = reach_.data();
  int* const object = object_.data();
  for (int i = 0; i < size_; ++i) {
    const float ax = low_x * x[i], bx = high_x * x[i];
    const float ay = low_y * y[i], by = high_y * y[i];
    const float az = low_z * z[i], bz = high_z * z[i];
    const float near = greater(greater(lesser(ax, bx), lesser(ay, by)), lesser(az, bz));
    const float far = lesser(lesser(greater(ax, bx), greater(ay, by)), greater(az, bz));
    const bool met = (near <= far) & (near > 0) & (near < reach[i]);
    reach[i] = met ? near : reach[i];
    object[i] = met ? index : object[i];
  }
}

void RayPacket::cast(const World& world, std::span<const int> candidates) {
  cast_room(world.room());
  for (const int index : candidates)
    cast_object(world.objects()[static_cast<std::size_t>(index)], index);
}

Hit RayPacket::hit(const World& world, int i) const {
  const bool inside = object_[i] == kRoom;
  const Box& box = inside ? world.room() : world.objects()[static_cast<std::size_t>(object_[i])];
  // The face is that of the first axis along which the ray crosses at its reach.
  const auto crossed = [&](int axis) {
    const float a = (box.min[axis] - origin_[axis]) * inverse_[axis][i];
    const float b = (box.max[axis] - origin_[axis]) * inverse_[axis][i];
    return (inside ? greater(a, b) : lesser(a, b)) == reach_[i];
  };
  const int axis = crossed(0) ? 0 : crossed(1) ? 1 : 2;
  const bool at_max = (along_[axis][i] > 0) == inside;
  return {reach_[i], &box, 2 * axis + (at_max ? 1 : 0)};
}

}  // namespace leviosim::traces
