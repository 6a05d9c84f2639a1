#include "traces/synthesis/hall.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "sim/base/parallel_for.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/hall_layout.h"
#include "traces/synthesis/painted_box.h"

namespace leviosim::traces {
namespace {

using Path = std::vector<Eigen::Vector3d>;

constexpr std::size_t kFaces = 6;
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

/// Of the clearance: tables are nearer than walls.
constexpr double kWorkshopShare = 0.3;

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
  base::parallel_for((1 + objects.size()) * kFaces, options.threads, [&](std::size_t job) {
    const std::size_t index = job / kFaces;
    const std::size_t face = job % kFaces;
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

}  // namespace leviosim::traces
