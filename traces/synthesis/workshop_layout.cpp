// A workshop: lay_out_workshop() of hall.h.
#include <algorithm>
#include <cmath>
#include <utility>

#include "traces/synthesis/hall_layout.h"
#include "traces/synthesis/layout_builder.h"

namespace leviosim::traces {
namespace {

using Eigen::Vector3d;
using Group = LayoutBuilder::Group;

/// Windows on one side: what looks up is bright, what looks down or away lies in deep shadow.
constexpr std::array<float, 6> kWorkshopLight{0.55f, 1.0f, 0.7f, 1.2f, 0.1f, 1.4f};
/// Dark walls, so that things in front of them are bright and what lies between is not.
constexpr std::array<HallFace, 6> kWorkshopFaces{{{SurfaceStyle::panels, 45},
                                                  {SurfaceStyle::bricks, 60},
                                                  {SurfaceStyle::planks, 45},
                                                  {SurfaceStyle::panels, 70},
                                                  {SurfaceStyle::planks, 50},
                                                  {SurfaceStyle::cloth, 20}}};

class WorkshopBuilder : public LayoutBuilder {
 public:
  using LayoutBuilder::LayoutBuilder;

  HallLayout build() {
    layout_.faces = kWorkshopFaces;
    layout_.light = kWorkshopLight;
    add_tables();
    scatter(&WorkshopBuilder::railing, 40);
    scatter(&WorkshopBuilder::cable, 80);
    scatter(&WorkshopBuilder::shelf, 60);
    scatter(&WorkshopBuilder::machine, 40);
    return std::move(layout_);
  }

 private:
  void add_tables();
  Group pallet(const Vector3d& middle, bool turned);
  Group heap(const Vector3d& corner, double height);
  Group railing();
  Group cable();
  Group shelf();
  Group machine();
};

/// Stacks of pallets, and nets on some, all along the path and just below it.
void WorkshopBuilder::add_tables() {
  constexpr double kStepM = 0.5;
  constexpr int kTries = 300;  // until hardly any more fit between those that are there
  Vector3d last = path_.front() - Vector3d(kStepM, 0, 0);
  for (const Vector3d& position : path_) {
    if ((position - last).norm() < kStepM) continue;
    last = position;
    for (int i = 0; i < kTries; ++i) {
      const double angle = rng_.uniform(0, 6.283);
      const double away = rng_.uniform(0, 2.2);
      const double deeper = rng_.uniform();  // most of them as near as may be
      const double below = clearance_m_ + 0.2 * deeper * deeper;
      const Vector3d middle =
          position + Vector3d(away * std::cos(angle), away * std::sin(angle), -below);
      const bool net = rng_.chance(0.16);
      if (net)
        add(heap(middle, rng_.uniform(0.2, 0.5)));
      else
        add(pallet(middle, rng_.chance(0.5)));
    }
  }
}

/// Boards with gaps on three joists, on a stack of others that reaches to the floor.
/// @param middle  of its upper side
Group WorkshopBuilder::pallet(const Vector3d& middle, bool turned) {
  const double length = rng_.uniform(0.5, 1.8);
  const int boards = 4 + rng_.below(3);
  const double board = rng_.uniform(0.1, 0.18);
  const double gap = rng_.uniform(0.02, 0.07);
  const double breadth = boards * board + (boards - 1) * gap;
  constexpr double kThick = 0.025, kJoist = 0.1;
  const auto turn = [turned](double x, double y, double z) {
    return turned ? Vector3d(y, x, z) : Vector3d(x, y, z);
  };
  const Vector3d corner = middle - turn(0.5 * length, 0.5 * breadth, 0);
  Group group;
  const double wood = tone(125, 170);
  for (int i = 0; i < boards; ++i)
    group.push_back(
        {box_at(corner + turn(0, i * (board + gap), -kThick), turn(length, board, kThick)),
         SurfaceStyle::timber, wood * rng_.uniform(0.85, 1.1), 130});
  for (const double at : {0.0, 0.5, 1.0})
    group.push_back({box_at(corner + turn(at * (length - kJoist), 0, -kThick - kJoist),
                            turn(kJoist, breadth, kJoist)),
                     SurfaceStyle::timber, 0.7 * wood});
  const double top = corner.z() - kThick - kJoist;
  const Vector3d inset = turn(0.1, 0.05, 0);
  Vector3d foot = corner + inset;
  foot.z() = low().z();
  const Vector3d size = turn(length, breadth, 0) - 2 * inset;
  if (top - foot.z() > 0.05)
    group.push_back(
        {box_at(foot, {size.x(), size.y(), top - foot.z()}), SurfaceStyle::stack, 0.4 * wood});
  return group;
}

/// A net over something, from `top` down.
Group WorkshopBuilder::heap(const Vector3d& top, double height) {
  const Vector3d size{rng_.uniform(0.4, 0.8), rng_.uniform(0.4, 0.8), height};
  const Vector3d corner = top - Vector3d(0.5 * size.x(), 0.5 * size.y(), height);
  Group group{{box_at(corner, size), SurfaceStyle::net, tone(150, 190)}};
  if (corner.z() - low().z() > 0.05)
    group.push_back({box_at({corner.x() + 0.03, corner.y() + 0.03, low().z()},
                            {size.x() - 0.06, size.y() - 0.06, corner.z() - low().z()}),
                     SurfaceStyle::stack, 50});
  return group;
}

/// Three rails on posts: thin, bright, all alike.
Group WorkshopBuilder::railing() {
  const bool along_x = rng_.chance(0.5);
  const double length = rng_.uniform(1.5, 4);
  const double z = rng_.chance(0.5) ? low().z() : rng_.uniform(low().z(), high().z() - 1.2);
  constexpr double kTube = 0.035, kHeight = 1.0, kPost = 0.8;
  Vector3d corner = floor_spot(along_x ? length : kTube, along_x ? kTube : length);
  corner.z() = z;
  const auto turn = [along_x](double x, double y, double zz) {
    return along_x ? Vector3d(x, y, zz) : Vector3d(y, x, zz);
  };
  Group group;
  const double metal = tone(80, 150);
  for (const double at : {0.35, 0.65, kHeight})
    group.push_back({box_at(corner + turn(0, 0, at), turn(length, kTube, kTube)),
                     SurfaceStyle::metal, metal, 120});
  for (double at = 0; at < length - kTube; at += kPost)
    group.push_back({box_at(corner + turn(at, kTube, 0), turn(kTube, kTube, kHeight)),
                     SurfaceStyle::metal, metal, 60});
  return group;
}

/// Hangs from the ceiling or runs below it.
Group WorkshopBuilder::cable() {
  constexpr double kThick = 0.02;
  const Vector3d spot = floor_spot(kThick, kThick);
  const double end = rng_.uniform(0, 0.8) * (high().z() - low().z());
  const Vector3d corner(spot.x(), spot.y(), low().z() + end);
  return {{box_at(corner, {kThick, kThick, high().z() - corner.z()}), SurfaceStyle::cloth,
           rng_.chance(0.5) ? 15.0 : 120.0}};
}

/// Boards, one above the other, with dark things between.
Group WorkshopBuilder::shelf() {
  const bool along_x = rng_.chance(0.5);
  const double length = rng_.uniform(0.8, 2), depth = rng_.uniform(0.3, 0.5);
  const auto turn = [along_x](double x, double y, double z) {
    return along_x ? Vector3d(x, y, z) : Vector3d(y, x, z);
  };
  const Vector3d footprint = turn(length, depth, 0);
  const Vector3d corner = floor_spot(footprint.x(), footprint.y());
  Group group;
  for (double z = 0.3; z < 2.2; z += 0.45) {
    group.push_back({box_at(corner + Vector3d(0, 0, z), turn(length, depth, 0.03)),
                     SurfaceStyle::timber, tone(60, 140)});
    for (double at = 0.05; at < length - 0.3; at += rng_.uniform(0.2, 0.4)) {
      const double edge = rng_.uniform(0.08, 0.18);
      group.push_back({box_at(corner + turn(at, 0.05, z + 0.03), Vector3d(edge, edge, 1.4 * edge)),
                       rng_.chance(0.3) ? SurfaceStyle::crate : SurfaceStyle::cloth,
                       tone(15, 120)});
    }
  }
  return group;
}

Group WorkshopBuilder::machine() {
  const Vector3d size{rng_.uniform(0.6, 1.8), rng_.uniform(0.6, 1.6), rng_.uniform(0.8, 2.4)};
  return {{box_at(floor_spot(size.x(), size.y()), size),
           rng_.chance(0.5) ? SurfaceStyle::cloth : SurfaceStyle::panels, tone(15, 80), 30}};
}

}  // namespace

HallLayout lay_out_workshop(std::span<const Vector3d> path, double clearance_m,
                            std::uint64_t seed) {
  return WorkshopBuilder(path, clearance_m, seed).build();
}

}  // namespace leviosim::traces
