// Surfaces all around a path at one distance: lay_out_surround() of hall_layout.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "traces/datasets/rng.h"
#include "traces/synthesis/hall_layout.h"
#include "traces/synthesis/painted_box.h"

namespace leviosim::traces {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr std::array<SurfaceStyle, 5> kBlockStyles{SurfaceStyle::plaster, SurfaceStyle::planks,
                                                   SurfaceStyle::bricks, SurfaceStyle::crate,
                                                   SurfaceStyle::panels};

/// A cube of a grid, by its number along each axis.
using Cell = std::array<int, 3>;

/// Distances from the path of the cells that come within `reach_m` of it.
std::map<Cell, double> cells_near(std::span<const Vector3d> path, double edge_m, double reach_m) {
  std::map<Cell, double> cells;
  const int reach = static_cast<int>(std::ceil(reach_m / edge_m)) + 1;
  for (const Vector3d& position : path) {
    const Vector3i here = (position / edge_m).array().floor().matrix().cast<int>();
    for (int i = -reach; i <= reach; ++i)
      for (int j = -reach; j <= reach; ++j)
        for (int k = -reach; k <= reach; ++k) {
          const Vector3i at = here + Vector3i(i, j, k);
          const Vector3d min = edge_m * at.cast<double>();
          const Eigen::AlignedBox3d box(min, Vector3d(min.array() + edge_m));
          const double distance = box.exteriorDistance(position);
          if (distance > reach_m) continue;
          const auto [cell, added] = cells.try_emplace({at.x(), at.y(), at.z()}, distance);
          if (!added) cell->second = std::min(cell->second, distance);
        }
  }
  return cells;
}

/// Across a face of the cell: rays leave what is free through one.
template <class Wanted>
bool has_neighbour(const Cell& cell, const Wanted& wanted) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int step : {-1, 1}) {
      Cell other = cell;
      other[axis] += step;
      if (wanted(other)) return true;
    }
  return false;
}

}  // namespace

HallLayout lay_out_surround(std::span<const Vector3d> path, double distance_m, std::uint64_t seed) {
  Rng rng(seed);
  Eigen::AlignedBox3d around;
  for (const Vector3d& position : path) around.extend(position);
  const double edge = 0.7 * distance_m;
  const double behind = 1.8 * edge;  // more than the diagonal of a cell
  HallLayout layout;
  layout.light = kObjectLight;
  layout.hall =
      Eigen::AlignedBox3d(around.min().array() - distance_m, around.max().array() + distance_m);
  for (HallFace& face : layout.faces)
    face = {
        kBlockStyles[static_cast<std::size_t>(rng.below(static_cast<int>(kBlockStyles.size())))],
        rng.uniform(60, 160)};
  // Where the path is wide, the box around it is too far away: cells fill it.
  const std::map<Cell, double> cells = cells_near(path, edge, distance_m + behind);
  const auto is_free = [&](const Cell& cell) {
    const auto found = cells.find(cell);
    return found != cells.end() && found->second < distance_m;
  };
  for (const auto& entry : cells) {
    const Cell& cell = entry.first;
    if (is_free(cell) || !has_neighbour(cell, is_free)) continue;
    const SurfaceStyle style =
        kBlockStyles[static_cast<std::size_t>(rng.below(static_cast<int>(kBlockStyles.size())))];
    const double tone = rng.uniform(60, 180);
    const Vector3d min = edge * Vector3d(cell[0], cell[1], cell[2]);
    const Eigen::AlignedBox3d box =
        Eigen::AlignedBox3d(min, Vector3d(min.array() + edge)).intersection(layout.hall);
    if (!box.isEmpty() && box.sizes().minCoeff() > 0.05 * edge)
      layout.objects.push_back({box, style, tone});
  }
  return layout;
}

}  // namespace leviosim::traces
