// Places things one after the other in a hall around a path; what would come too near to the path
// or into another thing is left out. What the things are is said by those who derive from it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <span>
#include <vector>

#include "traces/datasets/rng.h"
#include "traces/synthesis/hall_layout.h"

namespace leviosim::traces {

class LayoutBuilder {
 public:
  using Extent = Eigen::AlignedBox3d;
  using Vector3d = Eigen::Vector3d;
  using Group = std::vector<HallObject>;  ///< things that are placed together or not at all

  LayoutBuilder(std::span<const Vector3d> path, double clearance_m, std::uint64_t seed);

 protected:
  static Extent box_at(const Vector3d& min, const Vector3d& size) {
    return {min, Vector3d(min + size)};
  }
  const Vector3d& low() const { return layout_.hall.min(); }
  const Vector3d& high() const { return layout_.hall.max(); }

  bool fits(const Extent& box) const;
  bool add(const Group& group);
  template <class Builder>
  void scatter(Group (Builder::*make)(), int tries) {
    for (int i = 0; i < tries; ++i) add((static_cast<Builder*>(this)->*make)());
  }
  /// A place on the floor for something with this footprint.
  Vector3d floor_spot(double size_x, double size_y);
  double tone(double from, double to) { return rng_.uniform(from, to); }
  /// A box at wall 0 (-x), 1 (+x), 2 (-y) or 3 (+y), `along` from the wall's beginning.
  Extent against_wall(int wall, double along, double width, double depth, double z, double height,
                      double gap) const;

  std::span<const Vector3d> path_;
  double clearance_m_;
  Rng rng_;
  HallLayout layout_;

 private:
  bool clear_of_path(const Extent& box) const;
};

}  // namespace leviosim::traces
