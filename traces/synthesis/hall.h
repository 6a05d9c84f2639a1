// The world of flights that are rendered along a recorded path: lay_out_hall(), painted.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "traces/datasets/camera_model.h"
#include "traces/synthesis/world.h"

namespace leviosim::traces {

struct HallOptions {
  std::uint64_t seed = 1;    ///< of layout and textures
  double clearance_m = 0.8;  ///< between the path and every surface
  /// Texels are this many times as wide as the pixel that comes nearest to them, within 5 to 16 mm.
  /// Coarser paints faster.
  double texels = 1;
  unsigned threads = 0;  ///< 0: as many as the host has; the result does not depend on it
};

/// Memory: about 1 byte for each of some 50 million texels around a path of 10 m extent.
World make_hall(std::span<const Eigen::Vector3d> path, const CameraModel& camera,
                const HallOptions& options);

}  // namespace leviosim::traces
