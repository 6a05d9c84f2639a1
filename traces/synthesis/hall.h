// The world of flights that are rendered along a recorded path: boxes around it, painted.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "traces/datasets/camera_model.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/place.h"
#include "traces/synthesis/surface_painter.h"
#include "traces/synthesis/world.h"

namespace leviosim::traces {

struct HallOptions {
  std::uint64_t seed = 1;  ///< of layout and textures
  /// Between the path and every surface; of a workshop 0.3 of it; of a surround its distance.
  double clearance_m = 0.8;
  /// Texels are this many times as wide as the pixel that comes nearest to them, within 5 to 16 mm
  /// (workshop: 2 to 16, surround: 4 to 100). Coarser paints faster.
  double texels = 1;
  unsigned threads = 0;  ///< 0: as many as the host has; the result does not depend on it
  PlaceKind kind = PlaceKind::hall;
};

/// Memory: about 1 byte for each of some 50 million texels around a path of 10 m extent.
World make_hall(std::span<const Eigen::Vector3d> path, const CameraModel& camera,
                const HallOptions& options);

// Where things stand in a hall that is built around a given path: an industrial hall as large as
// the path asks for, with structure at many depths - pillars, beams, a mezzanine along one wall,
// racks, machines, tables, stacks of crates, boards on the walls. What would come too near to the
// path or into another thing is left out. A pure function of path and seed, before anything is
// painted.

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

// Places things one after the other in a hall around a path; what would come too near to the path
// or into another thing is left out. What the things are is said by those who derive from it.

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
