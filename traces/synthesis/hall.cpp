#include "traces/synthesis/hall.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "sim/base/threads.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/hall_layout.h"
#include "traces/synthesis/indoor_boxes.h"
#include "traces/synthesis/layout_builder.h"
#include "traces/synthesis/surface_painter.h"

namespace leviosim::traces {
namespace {

using Path = std::vector<Eigen::Vector3d>;

constexpr double kPathStepM = 0.05;
constexpr double kPatternDistanceM =
    1.5;  // at which the painter's patterns have their natural size

/// How fine textures are, and how large their patterns.
struct Range {
  double low, high;
};
struct PaintLimits {
  Range texel_m, scale;
};
constexpr PaintLimits kHallLimits{{0.005, 0.016}, {1, 4}};
constexpr PaintLimits kWorkshopLimits{{0.002, 0.016}, {1, 2}};
constexpr PaintLimits kSurroundLimits{{0.004, 0.1}, {0.2, 20}};

/// Of the clearance: tables are nearer than walls, within reach of an arm.
constexpr double kWorkshopShare = 0.08;

const PaintLimits& limits_of(PlaceKind kind) {
  return kind == PlaceKind::hall       ? kHallLimits
         : kind == PlaceKind::workshop ? kWorkshopLimits
                                       : kSurroundLimits;
}

/// Positions kPathStepM apart: the whole path is within that of one of them.
Path thinned(std::span<const Eigen::Vector3d> path) {
  Path result;
  for (const Eigen::Vector3d& position : path)
    if (result.empty() || (position - result.back()).norm() > kPathStepM)
      result.push_back(position);
  return result;
}

double distance(const Path& path, const Eigen::AlignedBox3d& surface) {
  double nearest = surface.exteriorDistance(path.front());
  for (const Eigen::Vector3d& position : path)
    nearest = std::min(nearest, surface.exteriorDistance(position));
  return nearest;
}

Eigen::AlignedBox3d face_of(const Box& box, std::size_t face) {
  Eigen::AlignedBox3d plate(box.min.cast<double>(), box.max.cast<double>());
  const auto axis = static_cast<Eigen::Index>(face / 2);
  const double at = face % 2 == 0 ? plate.min()[axis] : plate.max()[axis];
  plate.min()[axis] = plate.max()[axis] = at;
  return plate;
}

/// How a face must be painted for a path that comes this near.
SurfaceSpec spec_for(double distance_m, const CameraModel& camera, const HallOptions& options) {
  SurfaceSpec spec;
  const auto& [texel_m, scale] = limits_of(options.kind);
  spec.texel_m = options.texels * std::clamp(distance_m / camera.fx, texel_m.low, texel_m.high);
  spec.scale = std::clamp(distance_m / kPatternDistanceM, scale.low, scale.high);
  return spec;
}

HallLayout lay_out(const Path& path, const HallOptions& options) {
  const std::uint64_t seed = derive_seed(options.seed, 0);
  const double clearance_m = options.clearance_m + kPathStepM;
  if (options.kind == PlaceKind::hall) return lay_out_hall(path, clearance_m, seed);
  if (options.kind == PlaceKind::workshop)
    return lay_out_workshop(path, kWorkshopShare * options.clearance_m + kPathStepM, seed);
  return lay_out_surround(path, options.clearance_m, seed);
}

}  // namespace

World make_hall(std::span<const Eigen::Vector3d> path, const CameraModel& camera,
                const HallOptions& options) {
  const Path positions = thinned(path);
  const HallLayout layout = lay_out(positions, options);
  const auto box_of = [](const Eigen::AlignedBox3d& box, const std::array<float, 6>& light) {
    return unpainted_box(box.min().cast<float>(), box.max().cast<float>(), light);
  };
  Box room = box_of(layout.hall, kRoomLight);
  std::vector<Box> objects;
  for (const HallObject& object : layout.objects)
    objects.push_back(box_of(object.box, layout.light));
  base::parallel_for((1 + objects.size()) * kBoxFaces, options.threads, [&](std::size_t job) {
    const std::size_t index = job / kBoxFaces;
    const std::size_t face = job % kBoxFaces;
    Box& box = index == 0 ? room : objects[index - 1];
    SurfaceSpec spec = spec_for(distance(positions, face_of(box, face)), camera, options);
    spec.style = index == 0 ? layout.faces[face].style : layout.objects[index - 1].style;
    spec.tone = index == 0 ? layout.faces[face].tone : layout.objects[index - 1].tone;
    if (index > 0) box.faces[face].gloss = layout.objects[index - 1].gloss;
    spec.seed = derive_seed(options.seed, 1 + job);
    paint_face(box, face, spec);
  });
  return World(std::move(room), std::move(objects));
}

namespace {

using Eigen::Vector3d;
using Group = LayoutBuilder::Group;

constexpr std::array<HallFace, 6> kHallFaces{{{SurfaceStyle::plaster, 95},
                                              {SurfaceStyle::panels, 145},
                                              {SurfaceStyle::bricks, 170},
                                              {SurfaceStyle::plaster, 115},
                                              {SurfaceStyle::planks, 90},
                                              {SurfaceStyle::panels, 60}}};

class HallBuilder : public LayoutBuilder {
 public:
  using LayoutBuilder::LayoutBuilder;

  HallLayout build() {
    layout_.faces = kHallFaces;
    layout_.light = kObjectLight;
    add_mezzanine();
    add_beams();
    add_wall_pillars();
    scatter(&HallBuilder::free_pillar, 30);
    scatter(&HallBuilder::machine, 60);
    scatter(&HallBuilder::stack_of_crates, 90);
    scatter(&HallBuilder::table, 40);
    scatter(&HallBuilder::duct, 8);
    for (int wall = 0; wall < 4; ++wall) furnish_wall(wall);
    return std::move(layout_);
  }

 private:
  Group free_pillar();
  Group machine();
  Group stack_of_crates();
  Group table();
  Group duct();
  void add_mezzanine();
  void add_beams();
  void add_wall_pillars();
  void furnish_wall(int wall);
};

Group HallBuilder::free_pillar() {
  const double edge = rng_.uniform(0.25, 0.5);
  const Vector3d size(edge, edge, high().z() - low().z());
  return {{box_at(floor_spot(edge, edge), size), SurfaceStyle::plaster, tone(60, 170)}};
}

/// A large block with a smaller one on top.
Group HallBuilder::machine() {
  const Vector3d size{rng_.uniform(1.0, 2.6), rng_.uniform(0.9, 2.0), rng_.uniform(1.1, 2.6)};
  const Vector3d corner = floor_spot(size.x(), size.y());
  const Vector3d head{size.x() * rng_.uniform(0.3, 0.6), size.y() * rng_.uniform(0.3, 0.6),
                      rng_.uniform(0.4, 1.2)};
  const Vector3d shift{rng_.uniform() * (size.x() - head.x()),
                       rng_.uniform() * (size.y() - head.y()), size.z()};
  return {{box_at(corner, size), SurfaceStyle::panels, tone(45, 185)},
          {box_at(corner + shift, head), SurfaceStyle::panels, tone(40, 200)}};
}

Group HallBuilder::stack_of_crates() {
  Group group;
  double edge = rng_.uniform(0.5, 1.2);
  Vector3d corner = floor_spot(edge, edge);
  const int count = 1 + rng_.below(3);
  for (int i = 0; i < count; ++i) {
    const Vector3d size{edge, edge * rng_.uniform(0.8, 1.0), edge * rng_.uniform(0.6, 1.0)};
    group.push_back({box_at(corner, size), SurfaceStyle::crate, tone(60, 195)});
    const double smaller = edge * rng_.uniform(0.6, 0.8);
    corner += Vector3d(rng_.uniform() * (edge - smaller), 0, size.z());
    edge = smaller;
  }
  return group;
}

/// A table top on two trestles with something on it.
Group HallBuilder::table() {
  const double length = rng_.uniform(1.2, 2.0);
  const double depth = rng_.uniform(0.6, 0.9);
  const bool turned = rng_.chance(0.5);
  const auto turn = [turned](double x, double y, double z) {
    return turned ? Vector3d(y, x, z) : Vector3d(x, y, z);
  };
  const Vector3d footprint = turn(length, depth, 0);
  const Vector3d corner = floor_spot(footprint.x(), footprint.y());
  const double edge = rng_.uniform(0.25, 0.45);
  const double shift = rng_.uniform(0, length - edge);
  return {
      {box_at(corner + turn(0, 0, 0.75), turn(length, depth, 0.06)), SurfaceStyle::planks,
       tone(110, 160)},
      {box_at(corner + turn(0.1, 0.05, 0), turn(0.08, depth - 0.1, 0.75)), SurfaceStyle::plaster,
       tone(50, 80)},
      {box_at(corner + turn(length - 0.18, 0.05, 0), turn(0.08, depth - 0.1, 0.75)),
       SurfaceStyle::plaster, tone(50, 80)},
      {box_at(corner + turn(shift, 0.1, 0.81), Vector3d(edge, edge, edge)), SurfaceStyle::crate,
       tone(60, 195)},
  };
}

/// A channel hung below the beams.
Group HallBuilder::duct() {
  const bool along_x = rng_.chance(0.5);
  const Vector3d size = high() - low();
  const double across = rng_.uniform(0.1, 0.9);
  const double edge = rng_.uniform(0.3, 0.5);
  const double z = high().z() - 0.55 - edge;
  const Vector3d corner(along_x ? low().x() : low().x() + across * (size.x() - edge),
                        along_x ? low().y() + across * (size.y() - edge) : low().y(), z);
  return {
      {box_at(corner, along_x ? Vector3d(size.x(), edge, edge) : Vector3d(edge, size.y(), edge)),
       SurfaceStyle::panels, tone(110, 170)}};
}

/// A gallery along one wall: slab, supports, rails, and crates on it.
void HallBuilder::add_mezzanine() {
  const int wall = rng_.below(4);
  const double length = high()[wall < 2 ? 1 : 0] - low()[wall < 2 ? 1 : 0];
  const double depth = rng_.uniform(1.6, 2.1);
  const double z = rng_.uniform(2.4, 3.0);
  constexpr double kSlab = 0.2;
  if (!add({{against_wall(wall, 0, length, depth, z, kSlab, 0), SurfaceStyle::planks, 95}})) return;
  const double floor = z + kSlab;
  for (const double rail : {0.5, 1.0})
    add({{against_wall(wall, 0, length, 0.05, floor + rail, 0.05, depth - 0.1),
          SurfaceStyle::plaster, 170}});
  for (double along = 0.2; along < length - 0.3; along += 1.6)
    add({{against_wall(wall, along, 0.04, 0.04, floor, 0.5, depth - 0.1), SurfaceStyle::plaster,
          150}});
  for (double along = 0.2; along < length - 0.3; along += 3.2)
    add({{against_wall(wall, along, 0.25, 0.25, 0, z, depth - 0.3), SurfaceStyle::plaster, 75}});
  for (double along = rng_.uniform(0.3, 1); along < length - 1; along += rng_.uniform(1.0, 2.6)) {
    const double edge = rng_.uniform(0.5, 1.0);
    add({{against_wall(wall, along, edge, edge, floor, edge, 0.1), SurfaceStyle::crate,
          tone(60, 195)}});
  }
}

void HallBuilder::add_beams() {
  const Vector3d size = high() - low();
  const double spacing = rng_.uniform(2.2, 3.2);
  for (double x = 0.4 * spacing; x < size.x() - 0.4; x += spacing)
    add({{box_at({low().x() + x, low().y(), high().z() - 0.5}, {0.25, size.y(), 0.4}),
          SurfaceStyle::planks, tone(80, 130)}});
}

void HallBuilder::add_wall_pillars() {
  for (int wall = 0; wall < 4; ++wall) {
    const int axis = wall < 2 ? 1 : 0;
    const double length = high()[axis] - low()[axis];
    const double spacing = rng_.uniform(3.5, 5);
    for (double along = 0.5 * spacing; along < length - 0.5; along += spacing)
      add({{against_wall(wall, along, 0.4, 0.3, 0, high().z() - low().z() - 0.6, 0),
            SurfaceStyle::bricks, tone(70, 160)}});
  }
}

/// Racks, cabinets and, above them, boards.
void HallBuilder::furnish_wall(int wall) {
  const int axis = wall < 2 ? 1 : 0;
  const double length = high()[axis] - low()[axis];
  for (double along = rng_.uniform(0, 1); along < length; along += rng_.uniform(0.3, 1.2)) {
    const double width = rng_.uniform(0.8, 2.0);
    const auto style = rng_.chance(0.5) ? SurfaceStyle::panels : SurfaceStyle::planks;
    const double height = rng_.uniform(0.9, 2.3);
    if (add({{against_wall(wall, along, width, rng_.uniform(0.4, 0.7), 0, height, 0), style,
              tone(45, 185)}}))
      along += width;
  }
  for (double along = rng_.uniform(0, 1.5); along < length; along += rng_.uniform(1, 2.5)) {
    const double width = rng_.uniform(0.8, 1.8);
    const double z = rng_.uniform(2.4, std::max(2.5, high().z() - low().z() - 2.2));
    add({{against_wall(wall, along, width, 0.05, z, rng_.uniform(0.6, 1.2), 0), SurfaceStyle::crate,
          tone(130, 175)}});
    along += width;
  }
}

}  // namespace

HallLayout lay_out_hall(std::span<const Vector3d> path, double clearance_m, std::uint64_t seed) {
  return HallBuilder(path, clearance_m, seed).build();
}

}  // namespace leviosim::traces
