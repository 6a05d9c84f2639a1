#include "traces/synthesis/place.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/threads.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/hall_layout.h"
#include "traces/synthesis/indoor_boxes.h"
#include "traces/synthesis/surface_painter.h"
#include "traces/synthesis/world.h"

namespace leviosim::traces {
namespace {

constexpr double kNearestM = 0.2;
constexpr double kFarthestM = 100;

bool parse_seed(std::string_view text, std::uint64_t& seed) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  return error == std::errc() && end == text.data() + text.size() &&
         seed <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
}

/// Of "0.3m".
bool parse_distance(std::string_view text, double& distance_m) {
  return text.ends_with('m') && base::parse_number(text.substr(0, text.size() - 1), distance_m) &&
         distance_m >= kNearestM && distance_m <= kFarthestM;
}

}  // namespace

std::string Place::text() const {
  if (kind == PlaceKind::hall) return fmt::format("{}", seed);
  if (kind == PlaceKind::workshop) return fmt::format("workshop:{}", seed);
  return fmt::format("{}m:{}", distance_m, seed);
}

Place parse_place(const std::string& what, const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string kind = colon == std::string::npos ? "hall" : text.substr(0, colon);
  Place place;
  if (kind == "workshop")
    place.kind = PlaceKind::workshop;
  else if (parse_distance(kind, place.distance_m))
    place.kind = PlaceKind::surround;
  else if (kind != "hall")
    throw InputError(fmt::format(
        "{} '{}': there is no kind of world '{}'{}; expected hall, workshop, or a distance from "
        "{:g}m to {:g}m",
        what, text, kind, base::did_you_mean(kind, {"hall", "workshop"}), kNearestM, kFarthestM));
  if (!parse_seed(std::string_view(text).substr(colon == std::string::npos ? 0 : colon + 1),
                  place.seed))
    throw InputError(fmt::format(
        "{} '{}': expected a whole number from 0, or one behind its kind, such as workshop:4", what,
        text));
  return place;
}

// The indoor scene of the synthetic flight; see make_room() in world.h.

namespace {

constexpr std::array<SurfaceStyle, 6> kRoomStyles{SurfaceStyle::plaster, SurfaceStyle::bricks,
                                                  SurfaceStyle::panels,  SurfaceStyle::plaster,
                                                  SurfaceStyle::planks,  SurfaceStyle::panels};

constexpr std::array<double, 6> kRoomTones{150, 105, 130, 140, 100, 95};

struct ObjectRow {
  std::array<float, 3> min, max;
  SurfaceStyle style;
  double tone;
};

constexpr SurfaceStyle kPlaster = SurfaceStyle::plaster;
constexpr SurfaceStyle kPlanks = SurfaceStyle::planks;
constexpr SurfaceStyle kBricks = SurfaceStyle::bricks;
constexpr SurfaceStyle kCrate = SurfaceStyle::crate;
constexpr SurfaceStyle kPanels = SurfaceStyle::panels;

constexpr std::array<ObjectRow, 24> kObjects{{
    // pillars
    {{2.70f, 1.70f, 0.0f}, {3.05f, 2.05f, 4.0f}, kBricks, 110},
    {{-3.00f, -2.30f, 0.0f}, {-2.65f, -1.95f, 4.0f}, kBricks, 130},
    {{1.70f, -2.75f, 0.0f}, {1.95f, -2.50f, 4.0f}, kPanels, 85},
    // +x side: cabinet with a box on it, a table with a crate
    {{3.40f, -1.20f, 0.0f}, {4.00f, 0.40f, 2.1f}, kPanels, 95},
    {{3.45f, -0.90f, 2.1f}, {3.90f, -0.40f, 2.5f}, kCrate, 140},
    {{2.70f, -2.60f, 0.70f}, {3.80f, -1.60f, 0.76f}, kPlanks, 150},
    {{2.80f, -2.45f, 0.0f}, {2.90f, -2.35f, 0.70f}, kPlaster, 60},
    {{3.60f, -1.80f, 0.0f}, {3.70f, -1.70f, 0.70f}, kPlaster, 60},
    {{3.00f, -2.30f, 0.76f}, {3.45f, -1.85f, 1.20f}, kCrate, 125},
    // +y side: stacked crates, a low cabinet, a thin board on the wall
    {{0.60f, 2.40f, 0.0f}, {1.45f, 3.00f, 0.85f}, kCrate, 130},
    {{0.72f, 2.48f, 0.85f}, {1.25f, 2.97f, 1.45f}, kCrate, 100},
    {{-1.70f, 2.50f, 0.0f}, {-0.60f, 3.00f, 1.55f}, kPanels, 120},
    {{-1.45f, 2.60f, 1.55f}, {-1.05f, 2.90f, 1.95f}, kCrate, 155},
    {{1.70f, 2.93f, 1.1f}, {2.60f, 3.00f, 2.1f}, kCrate, 165},
    // -x side: locker, bench with a back
    {{-4.00f, 1.00f, 0.0f}, {-3.40f, 2.00f, 2.2f}, kPanels, 75},
    {{-4.00f, -1.20f, 0.0f}, {-3.30f, 0.60f, 0.50f}, kPlanks, 140},
    {{-4.00f, -1.20f, 0.50f}, {-3.80f, 0.60f, 1.05f}, kPlanks, 115},
    {{-3.75f, -0.60f, 0.50f}, {-3.35f, -0.20f, 0.95f}, kCrate, 150},
    // -y side: workbench with boxes, a board on the wall
    {{-0.80f, -3.00f, 0.0f}, {0.90f, -2.40f, 0.75f}, kPlanks, 105},
    {{-0.55f, -2.85f, 0.75f}, {0.00f, -2.50f, 1.15f}, kCrate, 145},
    {{0.25f, -2.90f, 0.75f}, {0.65f, -2.55f, 1.50f}, kPanels, 70},
    {{-2.30f, -3.00f, 1.0f}, {-1.10f, -2.93f, 2.0f}, kCrate, 165},
    // under the ceiling
    {{-4.00f, 0.90f, 3.55f}, {4.00f, 1.15f, 3.85f}, kPlanks, 110},
    {{-4.00f, -1.40f, 3.55f}, {4.00f, -1.15f, 3.85f}, kPlanks, 120},
}};

Eigen::Vector3f vector(const std::array<float, 3>& corner) {
  return {corner[0], corner[1], corner[2]};
}

}  // namespace

World make_room(std::uint64_t seed, double texel_m, unsigned threads) {
  Box room = unpainted_box({-4, -3, 0}, {4, 3, 4}, kRoomLight);
  std::vector<Box> objects;
  for (const ObjectRow& row : kObjects)
    objects.push_back(unpainted_box(vector(row.min), vector(row.max), kObjectLight));

  base::parallel_for((1 + kObjects.size()) * kBoxFaces, threads, [&](std::size_t job) {
    const std::size_t index = job / kBoxFaces;
    const std::size_t face = job % kBoxFaces;
    SurfaceSpec spec;
    spec.style = index == 0 ? kRoomStyles[face] : kObjects[index - 1].style;
    spec.tone = index == 0 ? kRoomTones[face] : kObjects[index - 1].tone;
    spec.texel_m = texel_m;
    spec.seed = derive_seed(seed, job);
    paint_face(index == 0 ? room : objects[index - 1], face, spec);
  });
  return World(std::move(room), std::move(objects));
}

// Surfaces all around a path at one distance: lay_out_surround() of hall.h.

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
