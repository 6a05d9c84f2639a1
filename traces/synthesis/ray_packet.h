// Rays of one camera cast together: coordinates stand in arrays, so that the compiler tests several
// rays against a box at a time. Each ray meets exactly what World::cast() says (a test holds that).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <span>

#include "traces/synthesis/world.h"

namespace leviosim::traces {

class RayPacket {
 public:
  static constexpr int kMost = 256;

  /// Points the rays: at most kMost directions in the camera frame, seen from `origin` in the
  /// world.
  void aim(const Eigen::Vector3f& origin, const Eigen::Matrix3f& R_world_camera,
           std::span<const Eigen::Vector3f> rays);
  /// Finds what each ray meets among the room and the objects with the given indices.
  void cast(const World& world, std::span<const int> candidates);

  int size() const { return size_; }
  Eigen::Vector3f direction(int i) const { return {along_[0][i], along_[1][i], along_[2][i]}; }
  /// After cast(world, ...).
  Hit hit(const World& world, int i) const;

 private:
  using Lane = std::array<float, kMost>;
  static constexpr int kRoom = -1;

  void cast_room(const Box& room);
  void cast_object(const Box& box, int index);

  Eigen::Vector3f origin_;
  int size_ = 0;
  alignas(64) std::array<Lane, 3> along_;    // directions in the world
  alignas(64) std::array<Lane, 3> inverse_;  // 1 / along
  alignas(64) Lane reach_;
  alignas(64) std::array<int, kMost> object_;
};

}  // namespace leviosim::traces
