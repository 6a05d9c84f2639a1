// Where things stand in a hall that is built around a given path: an industrial hall as large as
// the path asks for, with structure at many depths - pillars, beams, a mezzanine along one wall,
// racks, machines, tables, stacks of crates, boards on the walls. What would come too near to the
// path or into another thing is left out. A pure function of path and seed, before anything is
// painted.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "traces/synthesis/surface_painter.h"

namespace leviosim::traces {

struct HallObject {
  Eigen::AlignedBox3d box;  ///< [m], in the world
  SurfaceStyle style = SurfaceStyle::plaster;
  double tone = 120;  ///< mean grey level
  float gloss = 0;    ///< Surface::gloss
};

/// What a wall, the floor or the ceiling is made of.
struct HallFace {
  SurfaceStyle style = SurfaceStyle::plaster;
  double tone = 120;  ///< mean grey level
};

struct HallLayout {
  Eigen::AlignedBox3d hall;       ///< floor, ceiling and walls
  std::array<HallFace, 6> faces;  ///< of the hall, as those of a Box
  std::array<float, 6> light;     ///< on the faces of objects
  std::vector<HallObject> objects;
};

/// Every surface is at least `clearance_m` away from every position of the path, which has at least
/// one.
HallLayout lay_out_hall(std::span<const Eigen::Vector3d> path, double clearance_m,
                        std::uint64_t seed);

/// A workshop: pallets and nets just below the path, behind them rails, cables, shelves and dark
/// machines, in a dark hall with light from one side.
HallLayout lay_out_workshop(std::span<const Eigen::Vector3d> path, double clearance_m,
                            std::uint64_t seed);

/// Blocks around the path, the nearest of which are `distance_m` away wherever one looks, and
/// farther ones by at most that much again.
HallLayout lay_out_surround(std::span<const Eigen::Vector3d> path, double distance_m,
                            std::uint64_t seed);

}  // namespace leviosim::traces
