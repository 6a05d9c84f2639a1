// The world of flights that are rendered along a recorded path: boxes around it, painted.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <span>

#include "traces/datasets/camera_model.h"
#include "traces/synthesis/place.h"
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

}  // namespace leviosim::traces
