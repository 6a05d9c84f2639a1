#include "traces/synthesis/layout_builder.h"

#include <algorithm>

#include "traces/synthesis/hall_layout.h"

namespace leviosim::traces {
namespace {

using Eigen::Vector3d;

using Group = LayoutBuilder::Group;

}  // namespace

LayoutBuilder::LayoutBuilder(std::span<const Vector3d> path, double clearance_m, std::uint64_t seed)
    : path_(path), clearance_m_(clearance_m), rng_(seed) {
  Extent around;
  for (const Vector3d& position : path) around.extend(position);
  const auto margin = [this](double low, double high) {
    return std::max(clearance_m_, rng_.uniform(low, high));
  };
  // In braces the draws are made from left to right, whatever the compiler.
  const Vector3d below{margin(3, 4.5), margin(3, 4.5), margin(1, 1.3)};
  const Vector3d above{margin(3, 4.5), margin(3, 4.5), margin(2.5, 3.5)};
  layout_.hall = Extent(around.min() - below, around.max() + above);
}

bool LayoutBuilder::clear_of_path(const Extent& box) const {
  return std::all_of(path_.begin(), path_.end(), [&](const Vector3d& position) {
    return box.exteriorDistance(position) >= clearance_m_;
  });
}

bool LayoutBuilder::fits(const Extent& box) const {
  constexpr double kTouching = 1e-6;  // neighbours may touch
  const Extent core(box.min().array() + kTouching, box.max().array() - kTouching);
  return layout_.hall.contains(core) && clear_of_path(box) &&
         std::none_of(layout_.objects.begin(), layout_.objects.end(),
                      [&](const HallObject& other) { return other.box.intersects(core); });
}

bool LayoutBuilder::add(const Group& group) {
  const bool fit =
      std::all_of(group.begin(), group.end(), [this](const auto& o) { return fits(o.box); });
  if (fit) layout_.objects.insert(layout_.objects.end(), group.begin(), group.end());
  return fit;
}

Eigen::Vector3d LayoutBuilder::floor_spot(double size_x, double size_y) {
  const double x = rng_.uniform(low().x(), high().x() - size_x);
  const double y = rng_.uniform(low().y(), high().y() - size_y);
  return {x, y, low().z()};
}

Eigen::AlignedBox3d LayoutBuilder::against_wall(int wall, double along, double width, double depth,
                                                double z, double height, double gap) const {
  const bool at_x = wall < 2;
  const bool at_max = wall % 2 == 1;
  const int normal = at_x ? 0 : 1;
  const double near = at_max ? high()[normal] - gap - depth : low()[normal] + gap;
  const double begin = low()[1 - normal] + along;
  const Vector3d corner =
      at_x ? Vector3d(near, begin, low().z() + z) : Vector3d(begin, near, low().z() + z);
  return box_at(corner, at_x ? Vector3d(depth, width, height) : Vector3d(width, depth, height));
}

}  // namespace leviosim::traces
